//! Names that may be meant by others.

use std::borrow::Borrow;
use std::collections::HashMap;
use std::hash::Hash;

/// The Jaro similarity beyond which one name may be meant by another.
const MIN_ALIKE: f64 = 0.8;

/// The name most like this one, itself if it is one of them, and `None` if none is like it.
pub(crate) fn nearest<N: AsRef<str>>(name: &str, names: impl IntoIterator<Item = N>) -> Option<N> {
    let alike = names.into_iter().map(|known| (strsim::jaro(known.as_ref(), name), known));
    alike
        .filter(|(alike, _)| *alike > MIN_ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.as_ref().cmp(a.1.as_ref())))
        .map(|(_, nearest)| nearest)
}

/// What has the name, or the message that none of its kind has.
pub(crate) fn find<K, V>(kind: &str, name: &str, by_name: &HashMap<K, V>) -> Result<V, String>
where
    K: Borrow<str> + AsRef<str> + Eq + Hash,
    V: Copy,
{
    by_name.get(name).copied().ok_or_else(|| unknown(kind, name, by_name.keys()))
}

/// The message about a name that none of a kind has.
pub(crate) fn unknown<N: AsRef<str>>(kind: &str, name: &str, names: impl IntoIterator<Item = N>) -> String {
    let meant =
        nearest(name, names).map_or_else(String::new, |nearest| format!(": did you mean {:?}?", nearest.as_ref()));
    format!("no {kind} is called {name:?}{meant}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_name_is_answered_by_the_nearest() {
        let names = ["ball", "ball-2", "wall"];
        assert_eq!(unknown("body", "bal-2", names), "no body is called \"bal-2\": did you mean \"ball-2\"?");
        assert_eq!(unknown("body", "crane", names), "no body is called \"crane\"");
        assert_eq!(unknown("body", "", [""; 0]), "no body is called \"\"");
    }
}
