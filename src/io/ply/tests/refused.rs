//! Check what the refusal of a bad file says.

use super::super::parse;
use super::{ENDS, INDICES, XYZ, ascii, edges, faces, vertices};

/// Compares the one line of a refusal with the expected one.
fn refused(bytes: Vec<u8>, expected: &str) {
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let message = parse(&bytes).expect_err(&text);
    assert!(message.contains(expected), "{text}\n{message}\nshould say: {expected}");
    assert!(!message.contains('\n') && message.len() < 300, "{message}");
}

#[test]
fn what_is_no_ply_file() {
    refused(vec![], "line 1: not a PLY file: the first line must be `ply`");
    refused(b"plywood\n".into(), "line 1: not a PLY file");
    refused(vec![0xFF; 9], "line 1: not a PLY file");
    refused(b"ply".into(), "line 1: the header has no end_header: the file is truncated");
    refused(b"ply\nformat ascii 1.0\ncomment".into(), "line 3: the header has no end_header");
    refused(b"ply\nformat text 1.0\n".into(), "line 2: unknown format `text`; it must be ascii");
    refused(b"ply\nformat ascii 2.0\n".into(), "line 2: unknown format version `2.0`");
    refused(b"ply\nformat ascii\n".into(), "line 2: `format ascii` is not a line of a PLY header");
    refused(b"ply\nend_header\n".into(), "line 2: no format line; add `format ascii 1.0`");
}

#[test]
fn lines_of_the_header() {
    let header = |lines: &[&str], expected: &str| refused(ascii(lines, ""), expected);
    header(&["format ascii 1.0"], "line 3: the format is given twice; keep one");
    header(&["hello\tworld"], "line 3: `hello\\tworld` is not a line of a PLY header");
    header(&["property float x"], "line 3: a property before the first element");
    header(&["element vertex"], "line 3: `element vertex` is not a line");
    header(&["element a -1"], "line 3: element `a`: `-1` is not a count below 2^64");
    header(&["element a 18446744073709551616"], "is not a count below 2^64");
    header(&["element a 1", "element a 1"], "line 4: element `a` is declared twice");
    header(&["element a 1", "property half x"], "line 4: unknown type `half`; the types are char");
    header(&["element a 1", "property list float int i"], "line 4: property `i` counts its list");
    header(&["element a 1", "property list uchar int"], "line 4: `property list uchar int` is not");
    header(&[&"x".repeat(1000)], &format!("line 3: `{}...` is not a line", "x".repeat(40)));
}

#[test]
fn elements_and_properties() {
    let more = |more: &[&str], expected: &str| refused(vertices("1", more, "0 0 0"), expected);
    more(&[XYZ[1]], "line 7: property `y` of element `vertex` is declared twice");
    more(&["property float ny"], "element vertex has property ny but no nx");
    more(&["property float tvz"], "element vertex has property tvz but no tux");
    more(&["property float ty"], "element vertex has property ty but no tx");
    more(
        &["property uchar alpha", "property float opacity"],
        "element vertex has both opacity and alpha; keep one",
    );
    let colors = ["property float red", "property float green", "property float blue"];
    let leveled = |more: &[&str], expected: &str| {
        let all = colors.iter().chain(more).copied().collect::<Vec<_>>();
        refused(vertices("1", &all, "0 0 0"), expected);
    };
    let first =
        ["property float mip1_red", "property float mip1_green", "property float mip1_blue"];
    more(&first, "element vertex has property mip1_red but no red; levels are declared from 1 on");
    leveled(&first[1..], "element vertex has property mip1_green but no mip1_red; declare all");
    leveled(&["property float mip2_green"], "has property mip2_green but no mip1_red; levels are");
    let above = first.map(|name| name.replace("mip1", "mip3"));
    let above: Vec<&str> = first.into_iter().chain(above.iter().map(String::as_str)).collect();
    leveled(&above, "has property mip3_red but no mip2_red; levels are declared from 1 on");
    leveled(
        &["property float mip17_red"],
        "`mip17_red`, but prefiltered colours have at most 16 levels",
    );
    leveled(&["property float mip99999999999999999999_blue"], "have at most 16 levels");
    leveled(&["property char mip1_red"], "property `mip1_red` has type char, which cannot hold");
    leveled(&["property list uchar float mip1_red"], "property `mip1_red` is a list");
    more(&["property char red"], "property `red` has type char, which cannot hold a colour");
    let header = |lines: &[&str], expected: &str| refused(ascii(lines, ""), expected);
    header(&[], "there is no element vertex: the file holds no points");
    header(&["element vertex 1"], "element vertex has no properties x, y, z");
    header(&["element vertex 1", XYZ[0], XYZ[1]], "has property x but no z");
    header(
        &["element vertex 1", "property list uchar float x", XYZ[1], XYZ[2]],
        "element vertex: property `x` is a list, but must be one number",
    );
    refused(vertices("0", &[], ""), "element vertex has count 0: the file holds no points");
    // There are no vertices that corners could refer to.
    let empty = ["element face 1", INDICES, "element vertex 0", XYZ[0], XYZ[1], XYZ[2]];
    refused(ascii(&empty, "3 0 0 0\n"), "element vertex has count 0");
}

#[test]
fn counts_that_lie() {
    let three = "0 0 0\n1 0 0\n0 1 0\n";
    for count in ["4", "4294967296", "18446744073709551615"] {
        let declares = format!("element `vertex`: the header declares {count}, but the 18 bytes");
        refused(vertices(count, &[], three), &declares);
        refused(
            vertices(count, &[], three),
            "from line 8 on hold at most 3: the file is truncated",
        );
        let skipped = format!("element other {count}");
        let more = [skipped.as_str(), "property double a"];
        refused(vertices("3", &more, three), "element `other`: the header declares");
    }
    refused(vertices("2", &[], three), "line 10: 6 bytes are left over after the last element");
    refused(
        vertices("3", &[], "0 0 0\n1 0 0\n0     1\n"),
        "vertex 2 (line 11), property `z`: the file ends here: it is truncated, or a count",
    );
}

#[test]
fn values_of_vertices() {
    let rows = |rows, expected| refused(vertices("3", &[], rows), expected);
    rows("0 0 0\n1 0 0 7\n0 1 0\n", "vertex 1 (line 9): the line goes on after the last property");
    rows("0 0 0\n1.5 0\n0 1 0\n", "vertex 1 (line 10): the line goes on");
    rows(
        "0 0 0\n1 O 0\n0 1 0\n",
        "vertex 1 (line 9), property `y`: `O` is not a number of type float",
    );
    rows("0 0 \u{e4}\n1 0 0\n0 1 0\n", "property `z`: `\u{e4}` is not a number of type float");
    rows("0 0 \u{7}\n1 0 0\n0 1 0\n", "property `z`: `\\u{7}` is not a number of type float");
    let one = |property, value: &str, expected| {
        refused(vertices("1", &[property], &format!("0 0 0 {value}")), expected);
    };
    one(
        "property uchar alpha",
        "256",
        "vertex 0 (line 9), property `alpha`: `256` is not a number",
    );
    one("property char c", "1.0", "`1.0` is not a number of type char");
    one("property uint c", "-1", "`-1` is not a number of type uint");
}

#[test]
fn corners_of_faces() {
    let face = |face, expected| refused(faces(&[INDICES], face), expected);
    face(
        "3 0 1 3",
        "face 0 (line 13), property `vertex_indices`: vertex 3 does not exist; vertices are 0 to 2",
    );
    face("3 0 -1 2", "vertex -1 does not exist");
    face("3 0 1", "face 0 (line 14), property `vertex_indices`: the file ends here");
    face(
        "9 0 1 2",
        "face 0 (line 13), property `vertex_indices`: a list of 9 values, but only 7 bytes",
    );
    face("3 0 1 2 0", "face 0 (line 13): the line goes on");
    let list = |property, face, expected| refused(faces(&[property], face), expected);
    list("property list int int vertex_indices", "-3 0 1 2", "a list of -3 values; a count is");
    list(
        "property list uint int vertex_indices",
        "4294967295 0 1 2",
        "a list of 4294967295 values, but only",
    );
    list(
        "property list uchar float vertex_indices",
        "3 0 1 2",
        "property `vertex_indices` must be a list of integers",
    );
    list("property int vertex_index", "3", "property `vertex_index` must be a list of integers");
    list("property int flags", "3", "element face has no property list vertex_indices");
}

#[test]
fn ends_of_edges() {
    let ends = |rows, expected| refused(edges(&ENDS, rows), expected);
    ends(
        "0 1\n3 1",
        "edge 1 (line 18), property `vertex1`: vertex 3 does not exist; vertices are 0 to 2",
    );
    ends("0 1\n1 -1", "edge 1 (line 18), property `vertex2`: `-1` is not a number of type ushort");
    ends("-1 1\n1 1", "edge 0 (line 17), property `vertex1`: vertex -1 does not exist");
    ends("0 1\n1", "edge 1 (line 19), property `vertex2`: the file ends here");
    ends("0 1\n1 1 1", "edge 1 (line 18): the line goes on");
    let declared = |more: &[&str], expected| refused(edges(more, "0 1\n1 2"), expected);
    declared(&["property int a", ENDS[1]], "element edge has no property vertex1; declare it");
    declared(&ENDS[..1], "element edge has no property vertex2; declare it");
    declared(&["property float vertex1", ENDS[1]], "property `vertex1` must be one integer");
    let list = "property list uchar int vertex2";
    declared(&[ENDS[0], list], "element edge: property `vertex2` must be one integer");
    let many = edges(&ENDS, "");
    refused(many, "element `edge`: the header declares 2, but the");
}

const GROUP: &str = "property int group";
const ALSO: &str = "property list uchar int also";

/// Two vertices with groups, the first in group 0, then further declarations and values.
fn grouped(more: &[&str], value: &str, rest: &str, expected: &str) {
    let rows = format!("0 0 0 0 0\n0 0 0 {value}\n{rest}");
    refused(vertices("2", &[&[GROUP], more].concat(), &rows), expected);
}

#[test]
fn groups_of_vertices() {
    let own = |property: &str, value: &str, expected: &str| {
        let rows = format!("0 0 0 0\n0 0 0 {value}\n");
        refused(vertices("2", &[property], &rows), expected);
    };
    own(
        GROUP,
        "64",
        "vertex 1 (line 10), property `group`: group 64 does not exist; groups are 0 to",
    );
    own(GROUP, "-1", "property `group`: group -1 does not exist; groups are 0 to 63");
    own("property float group", "0", "property `group` must be one integer");
    own("property list uchar uchar group", "0", "property `group` must be one integer");
    let also = |property: &str, value: &str, expected: &str| {
        grouped(&[property], value, "", expected);
    };
    also("property int also", "0 0", "property `also` must be a list of integers");
    also("property list uchar float also", "0 0", "`also` must be a list of integers");
    also(ALSO, "3 2 4 3", "vertex 1 (line 11), property `also`: the vertex is in group 3 twice");
    also(ALSO, "3 3 1 2 1", "property `also`: the vertex is in group 1 twice; keep one");
    also(ALSO, "3 1 64", "property `also`: group 64 does not exist; groups are 0 to 63");
}

#[test]
fn scales_of_groups() {
    let scales = |[element, scale]: [&str; 2], value: &str, rest: &str, expected: &str| {
        grouped(&[ALSO, element, scale], value, rest, expected);
    };
    let one = ["element group 1", "property float scale"];
    scales(one, "1 0", "1\n", "surfel 1 is in group 1, but there are 2 surfels and 1 groups");
    scales(one, "0 1 2", "1\n", "surfel 1 is in group 2, but there are 2 surfels and 1 groups");
    scales(one, "0 0", "0\n", "group 0 (line 14), property `scale`: a scale of 0; it must be");
    scales(one, "0 0", "nan\n", "a scale of NaN; it must be finite and > 0");
    scales([one[0], "property float size"], "0 0", "1\n", "element group has no property scale");
    let list = "element group: property `scale` is a list, but must be one number";
    scales([one[0], "property list uchar float scale"], "0 0", "1 1\n", list);
    scales(["element group 65", one[1]], "0 0", "", "element group has count 65; groups are 1");
    scales(["element group 0", one[1]], "0 0", "", "element group has count 0; groups are 1 to 64");
}
