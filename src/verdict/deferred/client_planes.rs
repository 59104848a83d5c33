//! The planes that a client hands in, by the stage that judges them.

use crate::method::deferred::Settings;
use crate::method::deferred::visibility::Nearest;
use crate::method::ewa::attributes::Sums;
use crate::method::record::rows;
use crate::method::surface;
use crate::verdict::client::Client;
use crate::verdict::ewa::client_planes::{ClientPlanes, SumRows};

/// Only depth and surfel of the nearest fragment of pass 1.
pub(super) fn visibility(client: &Client) -> ClientPlanes<'_> {
    let [depth, id, _] = rows(&Nearest::<f32>::BEFORE);
    let (depth, id) = (client.scalar(&depth), client.index(&id));
    ClientPlanes { depth, id, depth_copy: None, id_copy: None, ..all_but_nearest(client) }
}

/// The planes after the selection. If depth and id of pass 3 are missing, the picture's are used,
/// and its empty pixels say nothing. With `second` off the picture's may come from pass 4, so they
/// are not used, because they say nothing about pass 1.
pub(super) fn rest<'a>(client: &'a Client, settings: &Settings) -> ClientPlanes<'a> {
    let all = all_but_nearest(client);
    let [depth, id, _] = rows(&Nearest::<f32>::BOTH);
    let (depth, id) = (client.scalar(&depth), client.index(&id));
    if depth.is_some() || id.is_some() || !settings.second {
        return ClientPlanes { depth, id, ..all };
    }
    ClientPlanes { depth: all.depth_copy, id: all.id_copy, empty_is_open: true, ..all }
}

/// Only depth and surfel of the picture. Its empty pixels say nothing.
pub(super) fn picture(client: &Client) -> ClientPlanes<'_> {
    let all = all_but_nearest(client);
    ClientPlanes { depth: all.depth_copy, id: all.id_copy, empty_is_open: true, ..all }
}

/// As [`rest`], for pixels where the picture's weight is a polygon's.
pub(super) fn of_polygons<'a>(client: &'a Client, rest: &ClientPlanes<'a>) -> ClientPlanes<'a> {
    let [_, _, weight, _] = rows(&Sums::<f32>::PLANES);
    let (weight, weight_copy) = (client.scalar(&weight), client.scalar(&surface::WEIGHT));
    ClientPlanes { weight, weight_copy, ..*rest }
}

/// All planes except the nearest fragment's, and the picture's copies of them.
fn all_but_nearest(client: &Client) -> ClientPlanes<'_> {
    let rows = SumRows { nearest: None, sums: rows(&Sums::<f32>::PLANES) };
    ClientPlanes {
        depth: None,
        id: None,
        depth_copy: client.scalar(&surface::DEPTH),
        id_copy: client.index(&surface::ID),
        weightless: true,
        ..ClientPlanes::from_client(client, &rows)
    }
}
