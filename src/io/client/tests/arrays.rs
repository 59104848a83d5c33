//! Planes in memory are read as those of files.

use super::*;

fn array(components: &[[f64; 4]], format: &str) -> Array {
    Array::new([2, 2], components.iter().map(|c| c.to_vec()).collect(), format).unwrap()
}

fn read_arrays(text: &str, arrays: &[(&str, Array)]) -> Result<Client> {
    let arrays = arrays.iter().map(|(key, array)| ((*key).to_owned(), array.clone())).collect();
    let ewa = Method::by_name("ewa").unwrap();
    Description::of_arrays(text, arrays)?.client(ewa.stages(), [2, 2], &Exec::sequential())
}

#[test]
fn arrays_need_no_file_and_have_the_keys_of_files() {
    let depth = array(&[[0.0, 0.25, 0.5, 1.0]], "f32");
    let ids = array(&[[-1.0, 1.0, 2.0, 3.0]], "i32");
    let color = array(&[[0.5; 4], [0.25; 4], [0.0; 4]], "f16");
    let text = "profile = \"ieee\"\norigin = \"bottom-left\"\n[planes.\"visibility.Z\"]\nmeaning = \"1/t\"\n";
    let all = [("visibility.Z", depth), ("visibility.id", ids), ("RGB", color)];
    let client = read_arrays(text, &all).unwrap();
    assert_eq!(client.rounding, Rounding::Ieee);
    let depth = client.frame().scalar("visibility.Z").unwrap();
    assert_eq!(depth.values(), [2.0, 1.0, f64::INFINITY, 4.0], "1/t, and rows run up");
    assert_eq!(client.frame().index("visibility.id").unwrap().values(), [2, 3, u32::MAX, 1]);
    assert_eq!(client.frame().color("").unwrap().values(), [[0.5, 0.25, 0.0]; 4]);
    assert_eq!(client.storage(""), Storage::Half);
}

#[test]
fn what_no_array_can_be_is_refused_without_a_path() {
    let one = array(&[[0.0; 4]], "f32");
    let refusal = |text: &str, key: &str| match read_arrays(text, &[(key, one.clone())]) {
        Err(Error::Format { path, what }) if path.as_os_str().is_empty() => what,
        other => panic!("{other:?}"),
    };
    assert!(refusal("", "normal").contains("planes.normal: 1 numbers a pixel"));
    assert!(refusal("", "depth").contains("no plane is called `depth`"));
    assert!(refusal("[planes.Z]\noffset = 3", "Z").contains("`offset` does not apply to an array"));
    assert!(refusal("[planes.Z]", "id").contains("planes.Z: no `file`"));
    assert!(refusal("sise = 3", "Z").contains("unknown key `sise`"));
    for (components, format) in [(vec![vec![0.0; 3]], "f32"), (vec![vec![0.0; 4]], "rgb10a2")] {
        assert!(Array::new([2, 2], components, format).is_err(), "{format}");
    }
    assert!(read_arrays("", &[]).is_err());
}
