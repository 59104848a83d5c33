//! Every stage of the reconstruction with templates against the oracle.

use crate::ewa::cases::Case;
use crate::ewa::stages::at;
use crate::kit::eye::V3;
use crate::kit::goldens;
use crate::kit::tolerance::{Arithmetic, Measured};
use crate::template::cases;
use crate::template::model::{Cell, Grid, Staying, Sums, Template, average, direction};
use crate::template::projection::{Fate, Projection, Shot};
use crate::template::rounded::Rounded;
use crate::template::tolerance::TEMPLATE;
use splatref::frame::{Exec, Frame, NO_ID, Samples};
use splatref::method::projection::Kind;
use splatref::method::template::{self, LevelRule, Settings};
use splatref::method::{Method, Picture};
use splatref::number::Exact;
use splatref::splat::Tally;

/// How many times its bound a rounding is taken for, where it decides. In f64 the oracle rounds
/// too.
pub(crate) const GUARD: f64 = 2.0;

/// 2^-24 or 2^-53.
pub(crate) fn unit(arithmetic: Arithmetic) -> f64 {
    if arithmetic == Arithmetic::F32 { (-24.0_f64).exp2() } else { (-53.0_f64).exp2() }
}

/// A plane that must be there.
pub(crate) fn plane<'a, R: Exact>(frame: &'a Frame<R>, name: &str) -> &'a Samples<R> {
    frame.plane(name).unwrap_or_else(|| panic!("no plane '{name}'"))
}

/// A level as the picture shows it; `names`: of its place.
pub(crate) fn grid<R: Exact>(frame: &Frame<R>, level: usize, [width, height]: [u32; 2]) -> Grid {
    let (stage, place) = match level {
        0 => ("projection".to_string(), "centre"),
        _ => (format!("level{level:02}"), "place"),
    };
    let named = |end: &str| plane(frame, &format!("{stage}.{end}"));
    let [id, depth, radius, extent, normal] = ["id", "Z", "radius", "extent", "normal"].map(named);
    let place = ["X", "Y"].map(|axis| named(&format!("{place}.{axis}")));
    let color = frame.plane(&stage);
    let cell = |i: usize| Cell {
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
            let Cell { depth, radius, extent, place: [px, py], normal, color, .. } = cell;
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

/// How many decisions were rounding's.
#[derive(Clone, Copy, Debug, Default)]
struct Open {
    pixels: usize,
    /// Pixels of the projection that several surfels may show: the crate's choice was taken.
    projected: usize,
    /// Cells of the levels, left out.
    merged: usize,
    /// Pixels of the reconstruction, left out.
    gathered: usize,
    /// Pixels whose normals cancel or whose light grazes, left out.
    shaded: usize,
    /// What the scenes exercise: cells of several centres, cells that lose some; pixels of several
    /// centres, with some behind, with some before.
    used: [usize; 5],
}

/// A picture's place in the test.
struct Subject<'a> {
    case: &'a Case,
    template: Template,
    projection: Projection,
    arithmetic: Arithmetic,
    measured: &'a mut Measured,
    open: Open,
}

impl<'a> Subject<'a> {
    fn new(
        case: &'a Case,
        settings: Settings,
        arithmetic: Arithmetic,
        measured: &'a mut Measured,
    ) -> Self {
        let size = [case.camera.width, case.camera.height];
        let unit = unit(arithmetic) * GUARD;
        let template = Template::new(settings, size, unit);
        let projection = Projection::new(&case.camera, settings.cull, unit);
        Self { case, template, projection, arithmetic, measured, open: Open::default() }
    }

    fn place(&self, x: u32, y: u32) -> String {
        let settings = &self.template.settings;
        format!("{:?} ({x}, {y}) of {:?}, {settings:?}", self.arithmetic, self.case)
    }

    /// Measures a number of a plane.
    fn measure(&mut self, key: &'static str, found: V3, expected: [Rounded; 3], [x, y]: [u32; 2]) {
        for (found, expected) in found.into_iter().zip(expected) {
            let error = (found - expected.value).abs();
            let bound = expected.units * unit(self.arithmetic);
            let deviation = if error == 0.0 { 0.0 } else { error / bound };
            let place = self.place(x, y);
            self.measured.add(key, self.arithmetic, deviation, || {
                format!("{place}: {found} for {} (unit {bound:e})", expected.value)
            });
        }
    }

    fn compare<R: Exact>(&mut self, picture: &Picture<R>) {
        let frame = &picture.frame;
        let shots = self.projection.shots(&self.case.scene);
        check_tally(&shots, &picture.tally, self.case);
        let sizes = self.template.sizes.clone();
        let grids: Vec<Grid> =
            sizes.iter().enumerate().map(|(level, size)| grid(frame, level, *size)).collect();
        assert!(frame.plane(&format!("level{:02}.id", grids.len())).is_none(), "beyond the top");
        self.projected(frame, &grids[0], &shots);
        for level in 1..grids.len() {
            self.moved(level - 1, &grids[level - 1], &grids[level]);
        }
        let levels = grids.iter().enumerate();
        let staying: Vec<Staying> =
            levels.flat_map(|(level, grid)| self.template.staying(level, grid)).collect();
        for pixel in grids[0].positions() {
            self.open.pixels += 1;
            self.gathered(frame, &staying, pixel);
            self.resolved(frame, pixel);
        }
    }

    /// The projection, pixel by pixel.
    fn projected<R: Exact>(&mut self, frame: &Frame<R>, grid: &Grid, shots: &[Shot]) {
        let mut lists = vec![Vec::new(); grid.cells.len()];
        for shot in shots {
            for [x, y] in &shot.pixels {
                lists[(y * grid.width + x) as usize].push(shot);
            }
        }
        for ([x, y], all) in grid.positions().zip(lists) {
            let (kind, place) = (plane(frame, "projection.kind"), self.place(x, y));
            let kind = at(kind, (y * grid.width + x) as usize)[0];
            let surely = all.iter().filter(|shot| shot.is_sure());
            let visible = |shot: &&Shot| !surely.clone().any(|s| s.hides(shot, self.template.unit));
            let may: Vec<&Shot> = all.iter().copied().filter(visible).collect();
            let empty = surely.count() == 0;
            self.open.projected += usize::from(may.len() + usize::from(empty) != 1);
            let Some(cell) = grid.at(x, y) else {
                assert!(empty, "{place}: empty");
                assert_eq!(kind, f64::from(Kind::Empty as u8), "{place}: kind");
                continue;
            };
            assert_eq!(kind, f64::from(Kind::Surface as u8), "{place}: kind");
            let Some(shot) = may.iter().find(|shot| shot.id == cell.id) else {
                panic!("{place}: shows {}, which cannot be", cell.id)
            };
            assert_eq!((cell.radius, cell.color), (shot.radius, shot.color), "{place}: copied");
            let back = shot.back.unwrap_or_else(|| {
                let along: f64 = (0..3).map(|i| shot.normal[i].value * cell.normal[i]).sum();
                along < 0.0
            });
            let normal = if back { shot.normal.map(|v| -v) } else { shot.normal };
            let [cx, cy] = shot.center;
            for (key, found, expected) in [
                ("projection.Z", [cell.depth; 3], [shot.depth; 3]),
                ("projection.extent", [cell.extent; 3], [shot.extent; 3]),
                ("projection.centre", [cell.place[0], cell.place[1], 0.0], [cx, cy, Rounded::ZERO]),
                ("projection.normal", cell.normal, normal),
            ] {
                self.measure(key, found, expected, [x, y]);
            }
        }
    }

    /// The level above `level`, cell by cell.
    fn moved(&mut self, level: usize, finer: &Grid, coarser: &Grid) {
        for [x, y] in coarser.positions() {
            let place = self.place(x, y);
            let Ok(expected) = self.template.merged(level, finer, [x, y]) else {
                self.open.merged += 1;
                continue;
            };
            let (found, expected) = match (coarser.at(x, y), expected) {
                (None, None) => continue,
                (Some(found), Some(expected)) => (found, expected),
                (found, expected) => {
                    let expected = expected.map(|e| e.id);
                    panic!("{place} over level {level}: {found:?} for {expected:?}")
                }
            };
            assert_eq!(found.id, expected.id, "{place} over level {level}: id");
            self.open.used[0] += usize::from(expected.members.len() > 1);
            self.open.used[1] += usize::from(!expected.lost.is_empty());
            let ([px, py], [ex, ey]) = (found.place, expected.place);
            for (key, found, expected) in [
                ("level.Z", [found.depth; 3], [expected.depth; 3]),
                ("level.radius", [found.radius; 3], [expected.radius; 3]),
                ("level.extent", [found.extent; 3], [expected.extent; 3]),
                ("level.place", [px, py, 0.0], [ex, ey, Rounded::ZERO]),
                ("level.normal", found.normal, expected.normal),
                ("level", found.color, expected.color),
            ] {
                self.measure(key, found, expected, [x, y]);
            }
        }
    }

    /// The sums of a pixel.
    fn gathered<R: Exact>(&mut self, frame: &Frame<R>, staying: &[Staying], [x, y]: [u32; 2]) {
        let Ok(expected) = self.template.gathered(staying, [x, y]) else {
            self.open.gathered += 1;
            return;
        };
        let place = self.place(x, y);
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
        for (sum, more) in self.open.used[2..].iter_mut().zip([expected.count - 1, hidden, anew]) {
            *sum += usize::from(more > 0);
        }
        assert_eq!(id, f64::from(expected.id), "{place}: id");
        assert_eq!(count, f64::from(expected.count.min(255)), "{place}: count");
        assert_eq!((depth, radius), (expected.depth, expected.radius), "{place}: front");
        assert_eq!(value("weight"), value("gathered.weight"), "{place}: weight");
        assert_eq!(value("A"), [1.0; 3], "{place}: A");
        for (key, expected) in [
            ("gathered.weight", [expected.weight; 3]),
            ("gathered.depths", [expected.depths; 3]),
            ("gathered.normal", expected.normal),
        ] {
            self.measure(key, value(key), expected, [x, y]);
        }
        if let Some(color) = color {
            self.measure("gathered", color, expected.color, [x, y]);
        }
    }

    /// Normalization and shading of the sums that the crate has.
    fn resolved<R: Exact>(&mut self, frame: &Frame<R>, [x, y]: [u32; 2]) {
        let i = (y * frame.width + x) as usize;
        let value = |name: &str| at(plane(frame, name), i);
        let place = self.place(x, y);
        let (weight, lit) = (value("gathered.weight")[0], frame.plane("normal").is_some());
        if weight == 0.0 {
            let normal = if lit { value("normal") } else { [0.0; 3] };
            assert_eq!((value("Z"), normal), ([f64::INFINITY; 3], [0.0; 3]), "{place}: empty");
            let black = self.case.scene.environment.is_none();
            assert!(!black || value("") == [0.0; 3], "{place}: the colour of an empty pixel");
            return;
        }
        self.measure("Z", value("Z"), average(value("gathered.depths"), weight), [x, y]);
        let own = self.case.scene.material.color.to_array().map(f64::from);
        let surface = match frame.plane("gathered") {
            Some(color) => average(at(color, i), weight),
            None => Rounded::vector(own),
        };
        assert!(lit || self.case.scene.lights.is_empty(), "{place}: lit without normals");
        let normal = if lit { value("normal") } else { [0.0; 3] };
        if lit {
            match direction(self.projection.view(), value("gathered.normal"), weight) {
                Some(expected) => self.measure("normal", normal, expected, [x, y]),
                None => self.open.shaded += 1,
            }
        }
        let seen = (value("Z")[0], normal, surface);
        match self.projection.shaded(&self.case.scene, [x, y], seen) {
            Some(expected) => self.measure("", value(""), expected, [x, y]),
            None => self.open.shaded += 1,
        }
    }
}

/// Every surfel has the fate it should have, if no rounding decides one.
fn check_tally(shots: &[Shot], tally: &Tally, case: &Case) {
    let sure = |fate| shots.iter().filter(|shot| shot.fate == Some(fate)).count() as u64;
    let open = shots.iter().filter(|shot| shot.fate.is_none()).count() as u64;
    let found = [tally.behind, tally.back_facing, tally.outside, tally.visible];
    let fates = [Fate::Behind, Fate::BackFacing, Fate::Outside, Fate::Visible];
    for (fate, found) in fates.into_iter().zip(found) {
        let range = sure(fate)..=sure(fate) + open;
        assert!(range.contains(&found), "{fate:?}: {found}, not in {range:?}, in {case:?}");
    }
    assert_eq!(tally.degenerate, 0, "{case:?}");
    assert_eq!(found.iter().sum::<u64>(), shots.len() as u64, "{case:?}");
}

/// All templates under both rules.
pub(crate) fn all_settings(cull: bool) -> Vec<Settings> {
    let rules = [LevelRule::Covering, LevelRule::Published];
    let sizes = [3, 5, 7].into_iter();
    sizes.flat_map(|size| rules.map(|levels| Settings { size, levels, cull })).collect()
}

/// Scenes by lot under all settings, and the goldens as they are.
fn subjects() -> Vec<(Case, Vec<Settings>)> {
    let lot = (0..84).map(|n| (cases::case(n), all_settings(n % 3 == 0)));
    let goldens = goldens::all().into_iter().filter_map(|golden| match golden.method {
        Method::Template(settings) => Some((golden.case, vec![settings])),
        _ => None,
    });
    // The count of goldens of this method, so that none is lost unnoticed.
    lot.chain(goldens::at_least(3, goldens.collect())).collect()
}

#[test]
fn every_stage_of_the_template_equals_the_oracle() {
    let exec = Exec::sequential();
    let mut measured = Measured::default();
    let mut all = [Open::default(); 2];
    let subjects = subjects();
    for (case, settings) in &subjects {
        for settings in settings {
            let (scene, camera) = (&case.scene, &case.camera);
            let mut narrow = Subject::new(case, *settings, Arithmetic::F32, &mut measured);
            let picture = template::render::<f32>(scene, camera, settings, &exec, true);
            narrow.compare(&picture.expect("renders"));
            let opens = [narrow.open, {
                let mut wide = Subject::new(case, *settings, Arithmetic::F64, &mut measured);
                let picture = template::render::<f64>(scene, camera, settings, &exec, true);
                wide.compare(&picture.expect("renders"));
                wide.open
            }];
            for (sum, open) in all.iter_mut().zip(opens) {
                sum.pixels += open.pixels;
                sum.projected += open.projected;
                sum.merged += open.merged;
                sum.gathered += open.gathered;
                sum.shaded += open.shaded;
                sum.used.iter_mut().zip(open.used).for_each(|(sum, more)| *sum += more);
            }
        }
    }
    println!("{} scenes; f32 and f64: {all:?}", subjects.len());
    for (key, (worst, place)) in &measured.0 {
        println!("{key:?}: {worst:.3} {place}");
    }
    for Open { pixels, projected, merged, gathered, shaded, used } in all {
        assert!(projected * 200 <= pixels, "{all:?}");
        assert!((merged + gathered + shaded) * 10_000 <= pixels, "{all:?}");
        assert!(used.iter().all(|used| *used >= 1000), "the scenes are too easy: {all:?}");
    }
    let complaints = measured.complaints(TEMPLATE);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
