//! The planes that a client has handed in, by the stage that judges them.

use crate::method::deferred::Settings;
use crate::method::deferred::visibility::Nearest;
use crate::method::ewa::attributes::Sums;
use crate::method::record::rows;
use crate::method::surface;
use crate::verdict::client::Client;
use crate::verdict::ewa::client_planes::{ClientPlanes, SumRows};

/// Depth and surfel of the nearest fragment of pass 1; nothing else.
pub(super) fn visibility(client: &Client) -> ClientPlanes<'_> {
    let [depth, id, _] = rows(&Nearest::<f32>::BEFORE);
    let (depth, id) = (client.scalar(&depth), client.index(&id));
    ClientPlanes { depth, id, depth_copy: None, id_copy: None, ..of(client) }
}

/// What follows the selection. Of the picture's depth and id, if those of pass 3 are not there, empty
/// pixels say nothing; with `second` off they may be those of pass 4, and say nothing of pass 1.
pub(super) fn rest<'a>(client: &'a Client, settings: &Settings) -> ClientPlanes<'a> {
    let all = of(client);
    let [depth, id, _] = rows(&Nearest::<f32>::BOTH);
    let (depth, id) = (client.scalar(&depth), client.index(&id));
    if depth.is_some() || id.is_some() || !settings.second {
        return ClientPlanes { depth, id, ..all };
    }
    ClientPlanes { depth: all.depth_copy, id: all.id_copy, empty_is_open: true, ..all }
}

/// Depth and surfel of the picture alone, of which empty pixels say nothing.
pub(super) fn picture(client: &Client) -> ClientPlanes<'_> {
    let all = of(client);
    ClientPlanes { depth: all.depth_copy, id: all.id_copy, empty_is_open: true, ..all }
}

/// The same as [`rest`] where the picture's weight is that of a polygon.
pub(super) fn of_polygons<'a>(client: &'a Client, rest: &ClientPlanes<'a>) -> ClientPlanes<'a> {
    let [_, _, weight, _] = rows(&Sums::<f32>::PLANES);
    let (weight, weight_copy) = (client.scalar(&weight), client.scalar(&surface::WEIGHT));
    ClientPlanes { weight, weight_copy, ..*rest }
}

/// All but what is nearest, of which there are copies.
fn of(client: &Client) -> ClientPlanes<'_> {
    let rows = SumRows { nearest: None, sums: rows(&Sums::<f32>::PLANES) };
    ClientPlanes {
        depth: None,
        id: None,
        depth_copy: client.scalar(&surface::DEPTH),
        id_copy: client.index(&surface::ID),
        weightless: true,
        ..ClientPlanes::of(client, &rows)
    }
}
