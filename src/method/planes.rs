//! Look up the planes that each method leaves, when it leaves them, and what they hold.
//!
//! A plane has the size of the picture. The column *when* says which pictures have the plane:
//!
//! | when | the plane is there |
//! |---|---|
//! | always | in every picture |
//! | lit | in every picture of a scene with lights, and with the planes of the stages |
//! | tubes | in every picture of a scene with tubes |
//! | stages | with the planes of the stages |
//! | stages, colours | the same, if the scene has colours |
//! | stages, tubes | the same, if the scene has tubes |
//! | stages, wide ids | the same, if ids have [more than 32 bits](crate::scene::objects::ids) |
//! | stages, setting | the same, under the setting that the last column names |
//! | stages, whole | the same, in a whole picture; not where the stage runs alone |
//! | alone | where the stage runs alone: the next stage reads the plane, and no picture keeps it |
//!
//! To keep the planes of the stages, call [`Session::define`] with `stages`. A scene has colours if
//! its surfels have colours. For the methods that draw primitives, it also has colours if any
//! primitives have them. Opacities, an environment and the number type do not change which planes
//! are there. The fast paths leave the planes of a picture without stages.
//!
//! If a stage runs alone ([`Session::stage`]), it leaves the rows of its stage as with the planes
//! of the stages. It does not leave the rows of *stages, whole*, and it also leaves the rows of
//! *alone*.
//!
//! A `#` stands for a digit of a number, which has leading zeros:
//!
//! | name | number |
//! |---|---|
//! | `group##`, `blended.group##`, `nearest.group##` | the group, 0 to K - 1 of K groups |
//! | `layer#` | the layer, 1 to the setting `layers`, at most [`peeling::STAGES`]; some empty |
//! | `pull##` | the level, 1 to L, the last of [`crate::frame::pyramid::sizes`] |
//! | `push##` | the level, 0 to L - 1 |
//! | `level##` | the level, 1 to the top of [`mod@super::template`] |
//!
//! If you run the stage `layers` of [`mod@super::peeling`] alone without planes of layers, it
//! begins with the first layer. If you give it the planes of the layers up to j - 1, it leaves the
//! planes of layer j alone.
//!
//! A stage without rows leaves no planes, because its results are the records of
//! [`crate::splat::record`].
//!
//! [`Session::define`]: super::Session::define
//! [`Session::stage`]: super::Session::stage
//! [`peeling::STAGES`]: super::peeling::STAGES
//!
#![doc = include_str!("planes.md")]
