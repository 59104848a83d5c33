//! Run the decoders of files so that a panic inside one becomes an error of its file.

use super::Reason;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

/// Runs a decoder, and turns a panic into an error without printing a message.
///
/// Every reader of a format that another crate decodes runs inside: EXR, PNG, and so textures and
/// environment maps. NPY runs inside too, although its reader is our own.
pub(super) fn guarded<T>(decode: impl FnOnce() -> T) -> Reason<T> {
    thread_local!(static SILENT: Cell<bool> = const { Cell::new(false) });
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let loud = panic::take_hook();
        panic::set_hook(Box::new(move |what| {
            if !SILENT.get() {
                loud(what);
            }
        }));
    });
    // Calls may nest: on one thread, a block is decoded inside its file.
    let outside = SILENT.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(decode));
    SILENT.set(outside);
    result.map_err(|_| "too damaged to decode; write it again".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_of_a_decoder_is_an_error_of_the_file() {
        let gone: Reason<()> = guarded(|| panic!("not to be seen"));
        assert!(gone.unwrap_err().contains("damaged"));
        assert_eq!(guarded(|| 1), Ok(1));
    }
}
