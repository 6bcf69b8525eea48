//! No file makes the program panic: it ends with 0 or 2.
//!
//! The library's own tests try thousands of texts; these few go all the way through the program,
//! where a stack overflow or an abort would show as a signal and a panic as exit code 101.

use crate::support::{Place, stderr};
use proptest::prelude::*;

proptest! {
    // Each case starts two processes.
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_end_with_an_exit_code_of_the_contract(
        start in prop::sample::select(vec!["", "{", "(", "{\"bodies\":[", "(bodies:[", "{\"bodies\":[{\"mass\":1}]}"]),
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        ron: bool,
    ) {
        let place = Place::new();
        let name = if ron { "scene.ron" } else { "scene.json" };
        place.write(name, [start.as_bytes(), &bytes].concat());
        for command in ["run", "inspect"] {
            let output = place.run(&[command, name]);
            prop_assert!(matches!(output.status.code(), Some(0 | 2)), "{:?} {}", output.status, stderr(&output));
        }
    }
}
