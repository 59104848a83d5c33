//! Which settings are traded, and their values.

/// A setting and what a study tries of it.
#[derive(Clone, Copy, Debug)]
pub struct Trade {
    /// The name of the setting, a row of [`crate::setting`].
    pub setting: &'static str,
    /// Whose setting it is.
    pub of: Of,
    /// The values, as on the command line. The default may be among them.
    pub values: &'static [&'static str],
}

/// Whose a setting is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// Of methods.
    Method,
    /// Of groups.
    Groups,
    /// Of the picture.
    Output,
}

/// Levels of detail that are tried.
#[derive(Clone, Copy, Debug)]
pub struct Details {
    /// Of points in an order: sizes of discs in px, see [`crate::scene::objects::detail::refine`].
    pub surfel_sizes: &'static [f32],
    /// Of a scene of one shape: its count divided by these.
    pub parts: &'static [usize],
}

/// See [`Details`].
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

/// The settings that are not traded, and why not: with [`TRADES`] these are all there are.
pub const NOT_TRADED: &[(&str, &str)] = &[
    ("kernel", "sets the outline, the cut-off and the filter, which are tried one by one"),
    ("low_pass", "belongs to the sharpness that a person wants"),
    ("cull", "says which surfaces are shown"),
    ("share", "leaves objects out that a person can see"),
    ("bins", "a picture of one frame shows no difference but arcs"),
    ("bin_edges", "says how arcs are spread over groups, at no cost"),
    ("refraction", "says what the surface is made of"),
    ("bends", "says what the surface is made of"),
    ("occluded", "differs where a surface lies just behind another"),
    ("subpixel_bits", "says which hardware is imitated"),
    ("opposite", "a rule of groups for thin parts"),
    ("coplanar", "a rule of groups for flat parts"),
    ("most", "belongs to what groups are extended by"),
    ("stages", "says what is written"),
    ("compression", "says how it is written"),
];
