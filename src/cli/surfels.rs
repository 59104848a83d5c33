//! `splatref surfels`: samples a mesh or a scene, or orders points, so that every prefix covers the
//! surface. A model becomes a PLY, a scene a folder.

mod points;

use super::{Ended, Ending, hierarchy, output, progress, report};
use clap::ValueEnum;
use glam::Vec3;
use points::InputPoints;
use splatref::frame::Exec;
use splatref::io::ply;
use splatref::io::scene_file::FileKind;
use splatref::progress::Progress;
use splatref::scene::{Camera, Cloud};
use splatref::source::candidates::{self, Directions};
use splatref::source::hierarchy::{self as approximations, MOST, Settings, Traversal};
use splatref::source::sampler::{
    Graph, Greedy, Order, Progressive, Schedule, Start, averaged, shuffled,
};
use splatref::{Error, Result};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = "\
Sample a mesh into points, or order the points of a file; every prefix covers the surface evenly. The
points of a mesh are the pixels that see it from outside. Each has a normal, and the colour, opacity
and --properties of the vertices around it. The points of a PLY keep every property of the file, in
its type.

Samplers:
  greedy                  take the point farthest from all points before; ties go to the lower
                          index; exact
  progressive             take the farthest of some random points, as in the paper
  progressive-as-shipped  the same, with the schedule of the authors' program
  random                  take a random point

An output name without extension is a folder: sample every part of a scene; rerun the command to
resume. The folder holds the triangles of each part, and the surfels of every part that has 1000
triangles or more: half as many surfels as triangles, at most 200000 or --count. Surfels keep
opacities and --properties.

Examples:
  splatref surfels city.toml -o city
  splatref surfels sheet.ply -o blue.ply --distance geodesic --average-colors 20000
  splatref surfels bunny.ply -o blue.ply --count 100000
  splatref surfels car.ply -o blue.ply --properties roughness,metallic
  splatref surfels scan.ply -o blue.ply --sampler greedy --start 3 --count 10000")]
pub(super) struct Args {
    /// A .ply, .obj, .las, .laz or .e57 with points or a mesh, or a scene .toml of meshes
    points: PathBuf,
    /// Write the ordered points, with every property of the file, into a PLY; or the hierarchy into
    /// a folder
    #[arg(short, long, value_name = "FILE.ply|FOLDER")]
    output: PathBuf,
    /// Order the points with this sampler
    #[arg(long, value_enum, default_value = "greedy")]
    sampler: Sampler,
    /// Begin with the point of this index; without it, --seed chooses one
    #[arg(long, value_name = "N")]
    start: Option<u32>,
    /// Set the random seed
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Write at most N points [default: all; for a mesh 100000]
    #[arg(long, value_name = "N")]
    count: Option<usize>,
    /// Measure distances straight, or along the surface (needs normals and --sampler greedy)
    #[arg(long, value_enum, default_value = "straight")]
    distance: Distance,
    /// Connect neighbours up to this far apart for distances along the surface, in world units
    /// [default: for a mesh, two pixels]
    #[arg(long, value_name = "LENGTH")]
    reach: Option<f32>,
    /// Average the colours of the first N points over the points nearest to each; nothing else
    /// changes
    #[arg(long, value_name = "N")]
    average_colors: Option<usize>,
    /// Sample a mesh with pictures of this side in pixels, one for each direction [default: 1024]
    #[arg(long, value_name = "N")]
    side: Option<u32>,
    /// Look at a mesh from these corners [default: cube]
    #[arg(long, value_enum)]
    directions: Option<Corners>,
    /// Replace the colours of a mesh by this texture: a .png, a .jpg or an .exr [default: the texture in
    /// the file]
    #[arg(long, value_name = "FILE")]
    texture: Option<PathBuf>,
    /// Sample these further vertex properties of a mesh, such as roughness,metallic; points keep
    /// all without it
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    properties: Vec<String>,
    /// Choose what the parts in a folder are sampled from [default: bottom-up]
    #[arg(long, value_enum)]
    traversal: Option<Way>,
    /// Use N threads; 0 uses every core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
}

#[derive(Clone, Copy, ValueEnum)]
enum Way {
    /// From all triangles of the part, which must fit into memory together
    TopDown,
    /// From the surfels of smaller parts, if they have any
    BottomUp,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Sampler {
    Greedy,
    Progressive,
    ProgressiveAsShipped,
    Random,
}

impl Sampler {
    fn name(self) -> String {
        self.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
    }
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Distance {
    /// Along a straight line
    Straight,
    /// Along a path of neighbours that face alike, which goes around thin walls
    Geodesic,
}

#[derive(Clone, Copy, ValueEnum)]
enum Corners {
    /// The corners of a cube around the mesh
    Cube,
    /// The corners of the bounding box of the mesh
    Box,
}

/// The default number of points for a mesh.
const OF_A_MESH: usize = 100_000;

pub(super) fn run(args: &Args) -> Ended {
    if hierarchy::is_folder(&args.output) {
        let settings = args.settings()?;
        return hierarchy::make(&args.points, &args.output, &settings, args.threads);
    }
    args.check()?;
    let exec = Exec::new(args.threads, 32)?;
    let steps = progress::Steps::new("loading");
    let show = |what: &str, done, of| steps.show(what, done, of);
    let of_file = |error: Error| match error {
        Error::Invalid(what) => Error::format(&args.points, what),
        other => other,
    };
    let InputPoints { cloud, pixel } = args.given(&exec, &show).map_err(of_file)?;
    let mesh = pixel.is_some();
    let kind = FileKind::from_extension(&args.points)?;
    let all = cloud.position.len();
    args.lacks(&cloud, mesh)?;
    let start = Instant::now();
    let count = args.count.unwrap_or(if mesh { OF_A_MESH } else { all });
    let graph = args.graph(&cloud, pixel, &exec, &show).map_err(of_file)?;
    let order = args.order(&cloud, graph.as_ref(), count, &exec, &show).map_err(of_file)?;
    let colors = args.colors(&cloud, &order, &exec, &show).map_err(of_file)?;
    let time = start.elapsed();
    let mut cloud = cloud.some(&order.index);
    if let (Some(all), Some(new)) = (&mut cloud.color, &colors) {
        all[..new.len()].copy_from_slice(new);
    }
    drop(steps);

    report::line(if mesh { "candidates" } else { "points" }, all);
    args.told(&order, graph.as_ref());
    if let Some(new) = &colors {
        report::line(
            "colours",
            format!("means over the nearest points, for the first {}", new.len()),
        );
    }
    report::line("time", format!("{:.2} s", time.as_secs_f64()));
    let recolored = colors.is_some();
    progress::during("writing", || match kind {
        // Points keep their place in the file, so that their rows can be copied.
        FileKind::Ply if !mesh => {
            ply::write_ordered(&args.output, &args.points, &order.index, &cloud, recolored)
        }
        _ => ply::write(&args.output, &cloud),
    })?;
    report::line("file", args.output.display());
    Ok(Ending::Good)
}

impl Args {
    /// The settings of a hierarchy.
    fn settings(&self) -> Result<Settings> {
        let refused = [
            (self.start.is_some(), "--start"),
            (self.distance == Distance::Geodesic, "--distance geodesic"),
            (self.reach.is_some(), "--reach"),
            (self.average_colors.is_some(), "--average-colors"),
            (self.texture.is_some(), "--texture"),
        ];
        if let Some((_, option)) = refused.iter().find(|(given, _)| *given) {
            let what = format!(
                "{option} does not apply to a folder; remove it, or give a name that ends in .ply"
            );
            return Err(Error::Usage(what));
        }
        self.check_numbers()?;
        let most = self.count.map_or(Ok(MOST), u32::try_from);
        Ok(Settings {
            most: most.map_err(|_| Error::Usage("--count: give less than 2^32".into()))?,
            side: self.side.unwrap_or(candidates::SIDE),
            directions: self.directions(),
            sampler: match self.sampler {
                Sampler::Greedy => approximations::Sampler::Greedy,
                Sampler::Progressive => approximations::Sampler::Progressive(Schedule::Paper),
                Sampler::ProgressiveAsShipped => {
                    approximations::Sampler::Progressive(Schedule::AsShipped)
                }
                Sampler::Random => approximations::Sampler::Random,
            },
            seed: self.seed,
            properties: self.properties.clone(),
            traversal: match self.traversal {
                None | Some(Way::BottomUp) => Traversal::BottomUp,
                Some(Way::TopDown) => Traversal::TopDown,
            },
        })
    }

    fn directions(&self) -> Directions {
        match self.directions {
            None | Some(Corners::Cube) => Directions::Cube,
            Some(Corners::Box) => Directions::Box,
        }
    }

    /// Refuses wrong numbers, for any kind of output.
    fn check_numbers(&self) -> Result<()> {
        if self.count == Some(0) {
            return Err(Error::Usage("--count 0 leaves no point; give at least 1".into()));
        }
        let Some(side) = self.side else { return Ok(()) };
        Camera::check_size(side, side)
            .map_err(|error| Error::Usage(format!("--side {side}: {error}")))
    }

    /// Prints the order.
    fn told(&self, order: &Order, graph: Option<&Graph>) {
        let (name, picked) = (self.sampler.name(), order.index.len());
        let first =
            order.index.first().map_or(String::new(), |first| format!(", from point {first}"));
        report::line("order", format!("{name}, {picked} of them{first}"));
        if let Some(graph) = graph {
            report::line("parts", format!("{}, not connected by a path", graph.parts()));
        }
        if let [_, .., last] = order.distance[..]
            && self.sampler == Sampler::Greedy
            && last.is_finite()
        {
            let apart = report::short(f64::from(last).sqrt());
            let along = if graph.is_some() { " along the surface" } else { "" };
            report::line("apart", format!("at least {apart}{along}, in world units"));
        }
    }

    /// Refuses wrong options before anything is read.
    fn check(&self) -> Result<()> {
        self.check_numbers()?;
        if self.traversal.is_some() {
            let what = "--traversal applies to a folder; remove it, or give a name without .ply";
            return Err(Error::Usage(what.into()));
        }
        if let Some(averaged) = self.average_colors
            && (averaged == 0 || self.count.is_some_and(|count| averaged > count))
        {
            let what = format!("--average-colors {averaged}: give 1 to the number of points");
            return Err(Error::Usage(what));
        }
        let along = self.distance == Distance::Geodesic;
        if along && self.sampler != Sampler::Greedy {
            let what = "--distance geodesic needs --sampler greedy; remove one of them";
            return Err(Error::Usage(what.into()));
        }
        if let Some(reach) = self.reach {
            if !along {
                return Err(Error::Usage("--reach needs --distance geodesic; add that".into()));
            }
            if !(reach > 0.0 && reach.is_finite()) {
                return Err(Error::Usage(format!("--reach {reach}: give a length above 0")));
            }
        }
        if self.sampler == Sampler::Random && self.start.is_some() {
            return Err(Error::Usage("--sampler random has no --start; remove one of them".into()));
        }
        let refused = |path: &Path, what| Err(Error::Usage(format!("{}: {what}", path.display())));
        let scene = matches!(FileKind::from_extension(&self.points), Ok(FileKind::Toml));
        let is_model = FileKind::from_extension(&self.points).is_ok_and(FileKind::is_model);
        if !(scene || is_model) {
            let what = "give points or a mesh as a .ply, .obj, .las, .laz or .e57, or a scene as a \
                        .toml";
            return refused(&self.points, what);
        }
        if scene && self.texture.is_some() {
            return refused(
                &self.points,
                "--texture applies to one mesh; name textures in the scene file",
            );
        }
        if !matches!(FileKind::from_extension(&self.output), Ok(FileKind::Ply)) {
            return refused(
                &self.output,
                "points are written as a PLY; give a name that ends in .ply",
            );
        }
        if !self.properties.is_empty()
            && matches!(FileKind::from_extension(&self.points), Ok(FileKind::Obj))
        {
            return refused(&self.points, "--properties needs a .ply; remove it");
        }
        output::check_folder(&self.output)?;
        output::check_other(&self.output, &self.points)
    }

    /// Checks that the points have what the options need.
    fn lacks(&self, cloud: &Cloud, mesh: bool) -> Result<()> {
        let along = self.distance == Distance::Geodesic;
        let what = if self.average_colors.is_some() && cloud.color.is_none() {
            "the file has no colours; remove --average-colors"
        } else if along && cloud.normal.is_none() {
            "the file has no normals, but --distance geodesic needs them; add nx, ny and nz, or \
             remove the option"
        } else if along && self.reach.is_none() && !mesh {
            "points need a --reach with --distance geodesic; give about twice the distance of \
             neighbours"
        } else {
            return Ok(());
        };
        Err(Error::format(&self.points, what))
    }

    /// The neighbour graph along the surface, if distances follow it.
    fn graph(
        &self,
        cloud: &Cloud,
        pixel: Option<f64>,
        exec: &Exec,
        show: Progress<'_>,
    ) -> Result<Option<Graph>> {
        let (Distance::Geodesic, Some(normal)) = (self.distance, &cloud.normal) else {
            return Ok(None);
        };
        let reach = self.reach.or(pixel.map(|pixel| (2.0 * pixel) as f32)).unwrap_or(0.0);
        Graph::new(&cloud.position, normal, reach, exec, show).map(Some)
    }

    /// The average colours of the first points, if `--average-colors` asks for them.
    fn colors(
        &self,
        cloud: &Cloud,
        order: &Order,
        exec: &Exec,
        show: Progress<'_>,
    ) -> Result<Option<Vec<Vec3>>> {
        let (Some(count), Some(color)) = (self.average_colors, &cloud.color) else {
            return Ok(None);
        };
        averaged(&cloud.position, color, order, count, exec, show).map(Some)
    }

    fn order(
        &self,
        cloud: &Cloud,
        graph: Option<&Graph>,
        count: usize,
        exec: &Exec,
        show: Progress<'_>,
    ) -> Result<Order> {
        let points = &cloud.position;
        let start = self.start.map_or(Start::Seed(self.seed), Start::Index);
        let progressive =
            |schedule| Progressive { start, seed: self.seed, schedule }.order(points, count, show);
        match self.sampler {
            Sampler::Greedy if let Some(graph) = graph => {
                Greedy { start }.along(graph, count, show)
            }
            Sampler::Greedy => Greedy { start }.order(points, count, exec, show),
            Sampler::Progressive => progressive(Schedule::Paper),
            Sampler::ProgressiveAsShipped => progressive(Schedule::AsShipped),
            Sampler::Random => shuffled(points, self.seed, count, show),
        }
    }
}
