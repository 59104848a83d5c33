//! Enums that know their variants and the names of these.

/// An enum with `ALL` and `name`.
macro_rules! named {
    (
        $(#[$about:meta])*
        pub(crate) enum $name:ident { $( $(#[$what:meta])* $variant:ident, )* }
    ) => {
        $(#[$about])*
        pub(crate) enum $name { $( $(#[$what])* $variant, )* }

        impl $name {
            /// Every one, in the order of the list.
            pub(crate) const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// What it is called in reports.
            pub(crate) fn name(self) -> &'static str {
                match self { $(Self::$variant => stringify!($variant),)* }
            }
        }
    };
}

pub(crate) use named;
