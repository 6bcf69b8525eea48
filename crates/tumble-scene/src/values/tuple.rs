//! Lists of values as files write them.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error as _, IgnoredAny, SeqAccess, Visitor};

pub(crate) type Triple = Tuple<f64, 3>;
pub(crate) type Quadruple = Tuple<f64, 4>;

/// Exactly `N` values, written `[..]` in JSON and `[..]` or `(..)` in RON.
///
/// serde's own arrays are tuples, which RON takes only in round brackets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tuple<T, const N: usize>(pub(crate) [T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Tuple<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values =
            deserializer.deserialize_any(List { exactly: Some(N), at_most: N, noun: "values", of: PhantomData })?;
        let count = values.len();
        <[T; N]>::try_from(values)
            .map(Tuple)
            .map_err(|_| D::Error::invalid_length(count, &format!("{N} values").as_str()))
    }
}

/// Reads a list, and stops reading where it is longer than anything sensible.
pub(crate) struct List<T> {
    pub(crate) exactly: Option<usize>,
    pub(crate) at_most: usize,
    pub(crate) noun: &'static str,
    pub(crate) of: PhantomData<T>,
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for List<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.exactly {
            Some(count) => write!(f, "a list of {count} {}", self.noun),
            None => write!(f, "a list of {}", self.noun),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
        let mut values = Vec::with_capacity(self.exactly.unwrap_or(0));
        while values.len() < self.at_most {
            match list.next_element()? {
                Some(value) => values.push(value),
                None => break,
            }
        }
        match self.exactly {
            Some(count) if values.len() < count => Err(A::Error::invalid_length(values.len(), &self)),
            _ if values.len() == self.at_most && list.next_element::<IgnoredAny>()?.is_some() => {
                Err(A::Error::custom(format_args!("more than {} {}", self.at_most, self.noun)))
            }
            _ => Ok(values),
        }
    }
}
