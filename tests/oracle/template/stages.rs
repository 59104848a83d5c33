//! Every stage of the reconstruction with templates against the oracle.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::check::{Check, Open, PROJECTION, vector};
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::goldens;
use crate::oracle::kit::number::{N3, Num, exact};
use crate::oracle::kit::planes::{at, plane};
use crate::oracle::kit::projection::{Projected, Sight};
use crate::oracle::kit::shade::{Surface, shaded};
use crate::oracle::kit::tolerance::{Arithmetic, Measured};
use crate::oracle::template::cases;
use crate::oracle::template::model::{Center, Grid, Staying, Sums, Template, average, direction};
use crate::oracle::template::tolerance::TEMPLATE;
use splatref::frame::{Frame, NO_ID};
use splatref::method::Picture;
use splatref::method::template::{Falloff, LevelRule, Settings};
use splatref::number::Exact;

/// A level as the picture shows it.
pub(crate) fn grid<R: Exact>(frame: &Frame<R>, level: usize, [width, height]: [u32; 2]) -> Grid {
    let stage = match level {
        0 => "projection".to_string(),
        _ => format!("level{level:02}"),
    };
    let named = |end: &str| plane(frame, &format!("{stage}.{end}"));
    let [id, depth, radius, extent, normal] = ["id", "Z", "radius", "extent", "normal"].map(named);
    let place = ["X", "Y"].map(|axis| named(&format!("center.{axis}")));
    let color = frame.plane(&stage);
    let cell = |i: usize| Center {
        id: at(id, i)[0] as u32,
        depth: at(depth, i)[0],
        radius: at(radius, i)[0],
        extent: at(extent, i)[0],
        place: place.map(|p| at(p, i)[0]),
        normal: at(normal, i),
        color: color.map_or([0.0; 3], |c| at(c, i)),
    };
    let mut cells = Vec::new();
    for i in 0..(frame.width * frame.height) as usize {
        let [x, y] = [i as u32 % frame.width, i as u32 / frame.width];
        let cell = cell(i);
        if cell.id == NO_ID {
            let Center { depth, radius, extent, place: [px, py], normal, color, .. } = cell;
            assert_eq!(depth, f64::INFINITY, "{stage}: an empty cell's depth");
            let rest = [[radius, extent, 0.0], [px, py, 0.0], normal, color];
            assert_eq!(rest, [[0.0; 3]; 4], "{stage}: an empty cell");
        }
        if x < width && y < height {
            cells.push((cell.id != NO_ID).then_some(cell));
        } else {
            assert_eq!(cell.id, NO_ID, "{stage}: beyond the level");
        }
    }
    Grid { width, height, cells }
}

/// What the scenes exercise: cells of several centres, cells that lose some; pixels of several
/// centres, with some behind, with some before.
type Used = [usize; 5];

/// One picture under test.
struct TemplateStages<'a, R, const P: u32> {
    case: &'a Case<()>,
    template: Template<P>,
    sight: Sight<P>,
    check: Check<'a, R, P>,
    used: &'a mut Used,
}

/// Compares a picture of a case, drawn under these settings.
fn compare<R: Exact, const P: u32>(
    case: &Case<()>,
    settings: Settings,
    arithmetic: Arithmetic,
    measured: &mut Measured,
    (open, used): &mut (Open, Used),
) {
    let Case { scene, camera, .. } = case;
    let Picture { frame, tally, .. } = Drawing::new(scene, camera, settings).define::<R>();
    let name = &format!("{case:?}, {settings:?}");
    let mut check = Check::<R, P> { name, frame: &frame, arithmetic, measured, open };
    let truth = Projected::new(scene, camera, settings.cull, 0);
    check.projection(case, &truth, &tally);
    let template = Template::new(settings, [camera.width, camera.height]);
    TemplateStages { case, template, sight: Sight::new(camera), check, used }.compare();
}

impl<R: Exact, const P: u32> TemplateStages<'_, R, P> {
    fn measure(&mut self, key: &'static str, found: [f64; 3], expected: N3<P>, at: [u32; 2]) {
        self.check.best(vec![vector(key, expected, found).to_vec()], || format!("{at:?}"));
    }

    fn compare(&mut self) {
        let frame = self.check.frame;
        let sizes = self.template.sizes.iter().enumerate();
        let grids: Vec<Grid> = sizes.map(|(level, size)| grid(frame, level, *size)).collect();
        assert!(frame.plane(&format!("level{:02}.id", grids.len())).is_none(), "beyond the top");
        for level in 1..grids.len() {
            self.moved(level - 1, &grids[level - 1], &grids[level]);
        }
        let levels = grids.iter().enumerate();
        let staying: Vec<Staying> =
            levels.flat_map(|(level, grid)| self.template.staying(level, grid)).collect();
        for pixel in grids[0].positions() {
            self.gathered(&staying, pixel);
            self.resolved(pixel);
        }
    }

    /// The level above `level`, cell by cell.
    fn moved(&mut self, level: usize, finer: &Grid, coarser: &Grid) {
        for [x, y] in coarser.positions() {
            let expected = self.template.merged(level, finer, [x, y]);
            self.check.open.count("levels", expected.is_err());
            let Ok(expected) = expected else { continue };
            let place = format!("({x}, {y}) of {}", self.check.name);
            let (found, expected) = match (coarser.at(x, y), expected) {
                (None, None) => continue,
                (Some(found), Some(expected)) => (found, expected),
                (found, expected) => {
                    let expected = expected.map(|e| e.id);
                    panic!("{place} over level {level}: {found:?} for {expected:?}")
                }
            };
            assert_eq!(found.id, expected.id, "{place} over level {level}: id");
            self.used[0] += usize::from(expected.members.len() > 1);
            self.used[1] += usize::from(!expected.lost.is_empty());
            let ([px, py], [ex, ey]) = (found.place, expected.place);
            for (key, found, expected) in [
                ("level.Z", [found.depth; 3], [expected.depth; 3]),
                ("level.radius", [found.radius; 3], [expected.radius; 3]),
                ("level.extent", [found.extent; 3], [expected.extent; 3]),
                ("level.center", [px, py, 0.0], [ex, ey, Num::ZERO]),
                ("level.normal", found.normal, expected.normal),
                ("level", found.color, expected.color),
            ] {
                self.measure(key, found, expected, [x, y]);
            }
        }
    }

    /// The sums of a pixel.
    fn gathered(&mut self, staying: &[Staying], [x, y]: [u32; 2]) {
        let expected = self.template.gathered(staying, [x, y]);
        self.check.open.count("gathering", expected.is_err());
        let Ok(expected) = expected else { return };
        let (frame, place) = (self.check.frame, format!("({x}, {y}) of {}", self.check.name));
        let i = (y * frame.width + x) as usize;
        let value = |name: &str| at(plane(frame, name), i);
        let color = frame.plane("gathered").map(|c| at(c, i));
        let [id, count, depth, radius] =
            ["id", "gathered.count", "gathered.Z", "gathered.radius"].map(|name| value(name)[0]);
        let Some(expected) = expected else {
            assert_eq!((id as u32, depth), (NO_ID, f64::INFINITY), "{place}: empty");
            let names = ["gathered.weight", "gathered.depths", "gathered.normal", "weight"];
            assert_eq!(names.map(value), [[0.0; 3]; 4], "{place}: empty");
            let seen = if self.case.scene.environment.is_some() { 1.0 } else { 0.0 };
            assert_eq!(value("A"), [seen; 3], "{place}: A of an empty pixel");
            assert_eq!((count, radius), (0.0, 0.0), "{place}: empty");
            assert_eq!(color.unwrap_or_default(), [0.0; 3], "{place}: empty");
            return;
        };
        let Sums { hidden, anew, .. } = expected;
        for (sum, more) in self.used[2..].iter_mut().zip([expected.count - 1, hidden, anew]) {
            *sum += usize::from(more > 0);
        }
        assert_eq!(id, f64::from(expected.id), "{place}: id");
        assert_eq!(count, f64::from(expected.count.min(255)), "{place}: count");
        assert_eq!((depth, radius), (expected.depth, expected.radius), "{place}: front");
        assert_eq!(value("weight"), value("gathered.weight"), "{place}: weight");
        assert_eq!(value("A"), [1.0; 3], "{place}: A");
        // Exponentials have rows of their own: two libraries may give two of them.
        let row = match self.template.settings.falloff {
            Falloff::Linear => {
                ["gathered.weight", "gathered.depths", "gathered.normal", "gathered"]
            }
            Falloff::Gaussian => GAUSSIAN,
        };
        for (row, (plane, expected)) in row.into_iter().zip([
            ("gathered.weight", [expected.weight; 3]),
            ("gathered.depths", [expected.depths; 3]),
            ("gathered.normal", expected.normal),
        ]) {
            self.measure(row, value(plane), expected, [x, y]);
        }
        if let Some(color) = color {
            self.measure(row[3], color, expected.color, [x, y]);
        }
    }

    /// Normalization and shading of the sums that the crate has.
    fn resolved(&mut self, [x, y]: [u32; 2]) {
        let (Case { scene, .. }, frame) = (self.case, self.check.frame);
        let i = (y * frame.width + x) as usize;
        let value = |name: &str| at(plane(frame, name), i);
        let place = format!("({x}, {y}) of {}", self.check.name);
        let (weight, lit) = (value("gathered.weight")[0], frame.plane("normal").is_some());
        if weight == 0.0 {
            let normal = if lit { value("normal") } else { [0.0; 3] };
            assert_eq!((value("Z"), normal), ([f64::INFINITY; 3], [0.0; 3]), "{place}: empty");
            let black = scene.environment.is_none();
            assert!(!black || value("") == [0.0; 3], "{place}: the colour of an empty pixel");
            return;
        }
        self.measure("Z", value("Z"), average(value("gathered.depths"), weight), [x, y]);
        let own = scene.material.color.to_array().map(f64::from);
        let surface = match frame.plane("gathered") {
            Some(color) => average(at(color, i), weight),
            None => exact(own),
        };
        assert!(lit || scene.lights.is_empty(), "{place}: lit without normals");
        let normal = if lit { value("normal") } else { [0.0; 3] };
        if lit {
            let expected = direction(&self.sight, value("gathered.normal"), weight);
            self.check.open.count("shading", expected.is_none());
            if let Some(expected) = expected {
                self.measure("normal", normal, expected, [x, y]);
            }
        }
        let surface = Surface { depth: value("Z")[0], normal, tangent: [0.0; 3], color: surface };
        let outcomes = shaded(scene, &self.sight, (x, y), &surface);
        self.check.open.count("shading", outcomes.len() > 1);
        let outcomes = outcomes.into_iter().map(|c| vector("", c, value("")).to_vec()).collect();
        self.check.best(outcomes, || format!("shaded ({x}, {y})"));
    }
}

/// The rows of what is gathered with exponential weights.
const GAUSSIAN: [&str; 4] = ["gaussian.weight", "gaussian.depths", "gaussian.normal", "gaussian"];

/// All templates under all rules, and one rule with the other weight.
pub(crate) fn all_settings(cull: bool) -> Vec<Settings> {
    let rules = [
        (LevelRule::Radius, Falloff::Linear),
        (LevelRule::Diameter, Falloff::Linear),
        (LevelRule::Diameter, Falloff::Gaussian),
        (LevelRule::Covering, Falloff::Linear),
    ];
    let of = |size| rules.map(|(levels, falloff)| Settings { size, levels, falloff, cull });
    [3, 5, 7].into_iter().flat_map(of).collect()
}

/// Scenes by lot under all settings, and the goldens as they are.
fn subjects() -> Vec<(Case<()>, Vec<Settings>)> {
    let lot = (0..84).map(|n| (cases::case(n), all_settings(n % 3 == 0)));
    let goldens = goldens::of().into_iter().map(|golden: Case<Settings>| {
        let settings = vec![golden.settings];
        (golden.with(()), settings)
    });
    lot.chain(goldens).collect()
}

#[test]
fn every_stage_of_the_template_equals_the_oracle() {
    let (mut measured, mut all) = (Measured::default(), <[(Open, Used); 2]>::default());
    let subjects = subjects();
    for (case, settings) in &subjects {
        for settings in settings {
            let [narrow, wide] = &mut all;
            compare::<f32, 24>(case, *settings, Arithmetic::F32, &mut measured, narrow);
            compare::<f64, 53>(case, *settings, Arithmetic::F64, &mut measured, wide);
        }
    }
    println!("{} scenes; f32 and f64: {all:?}", subjects.len());
    for (open, used) in &all {
        let [pixels, projected] = open.get(PROJECTION);
        assert!(projected * 200 <= pixels, "{all:?}");
        let left = ["levels", "gathering", "shading"].map(|stage| open.get(stage)[1]);
        assert!(left.iter().sum::<u64>() * 10_000 <= pixels, "{all:?}");
        assert!(used.iter().all(|used| *used >= 1000), "the scenes are too easy: {all:?}");
    }
    measured.check(TEMPLATE);
}
