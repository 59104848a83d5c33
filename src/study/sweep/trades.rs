//! The settings that a study varies, and their values.

/// A setting, and the values to try.
#[derive(Clone, Copy, Debug)]
pub struct Trade {
    /// The name of the setting, a row of [`crate::setting`].
    pub setting: &'static str,
    /// The owner of the setting.
    pub of: Of,
    /// The values, as on the command line. They may include the default.
    pub values: &'static [&'static str],
}

/// The owner of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// A method.
    Method,
    /// The groups.
    Groups,
    /// The output.
    Output,
}

/// The levels of detail to try.
#[derive(Clone, Copy, Debug)]
pub struct Details {
    /// For ordered points: sizes of discs in px; see [`crate::scene::objects::detail::refine`].
    pub surfel_sizes: &'static [f32],
    /// For a scene of one shape: divisors of its count.
    pub parts: &'static [usize],
}

/// The levels of detail to try; see [`Details`].
pub const DETAILS: Details = Details { surfel_sizes: &[1.0, 2.0, 4.0, 8.0], parts: &[4, 16] };

const fn of_method(setting: &'static str, values: &'static [&'static str]) -> Trade {
    Trade { setting, of: Of::Method, values }
}

const fn of_groups(setting: &'static str, values: &'static [&'static str]) -> Trade {
    Trade { setting, of: Of::Groups, values }
}

/// The settings, in the order in which they are tried.
pub const TRADES: &[Trade] = &[
    of_method("outline", &["affine", "perspective", "raycast"]),
    of_method("template", &["3", "5", "7"]),
    of_method("depth", &["plain", "voronoi"]),
    of_groups("overlap", &["0", "0.4", "0.8", "1"]),
    of_groups("count", &["1", "2", "4", "8"]),
    of_method("weights", &["box", "gaussian"]),
    of_method("levels", &["radius", "diameter", "covering"]),
    of_method("epsilon", &["0.5r", "1r", "2r", "4r"]),
    of_method("cutoff", &["1", "1.5", "2", "3"]),
    of_method("order", &["depth", "distance", "steps", "pixel"]),
    of_method("support", &["ellipse", "tiles", "boxes"]),
    of_method("stop", &["0", "0.0001", "0.01"]),
    of_method("flags", &["8", "64", "512"]),
    of_method("second", &["on", "off"]),
    of_method("falloff", &["linear", "gaussian"]),
    of_method("holes", &["skipped", "background"]),
    of_groups("extend", &["none", "add", "enlarge"]),
    of_method("peel", &["4", "16", "64"]),
    Trade { setting: "number", of: Of::Output, values: &["f32", "f64"] },
    Trade { setting: "storage", of: Of::Output, values: &["f32", "f16", "unorm8"] },
    Trade {
        setting: "depth_storage",
        of: Of::Output,
        values: &["f32", "f16", "unorm24", "unorm16"],
    },
];

/// The settings that a study does not vary, and why. Together with [`TRADES`] these are all
/// settings.
pub const NOT_TRADED: &[(&str, &str)] = &[
    ("kernel", "sets outline, cut-off and filter together, which are tried one by one"),
    ("preset", "sets other settings together, which are tried one by one"),
    ("disc", "chooses what a Gaussian is: an ellipsoid or a disc"),
    ("near_depth", "drops what a person can see"),
    ("clamp", "matters only beside the picture"),
    ("compensation", "sets the sharpness, which is a matter of taste"),
    ("degree", "chooses what is shown"),
    ("color_bounds", "chooses what is shown"),
    ("least_alpha", "costs what the support costs"),
    ("most_alpha", "chooses what is shown"),
    ("stop_at", "matters only at one number"),
    ("blend", "chooses what is shown"),
    ("low_pass", "sets the sharpness, which is a matter of taste"),
    ("cull", "chooses which surfaces are shown"),
    ("share", "leaves out objects that a person can see"),
    ("bins", "changes nothing but arcs in a picture of one frame"),
    ("bin_edges", "spreads arcs over groups, at no cost"),
    ("refraction", "describes the material"),
    ("bends", "describes the material"),
    ("occluded", "matters only where a surface lies just behind another"),
    ("subpixel_bits", "chooses the emulated hardware"),
    ("opposite", "sets a rule of groups for thin parts"),
    ("coplanar", "sets a rule of groups for flat parts"),
    ("most", "belongs to the extension of groups"),
    ("stages", "chooses what is written"),
    ("compression", "chooses how it is written"),
];
