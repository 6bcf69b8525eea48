//! Moments in time, which the standard library does not have in a browser.

#[cfg(not(target_family = "wasm"))]
pub(crate) use std::time::Instant;

#[cfg(target_family = "wasm")]
pub(crate) use in_a_browser::Instant;

#[cfg(target_family = "wasm")]
mod in_a_browser {
    use std::ops::Add;
    use std::time::Duration;

    use macroquad::miniquad::date;

    /// As that of the standard library, but by the clock on the wall: it may go back.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub(crate) struct Instant(Duration);

    impl Instant {
        pub(crate) fn now() -> Self {
            Self(Duration::try_from_secs_f64(date::now()).unwrap_or_default())
        }

        pub(crate) fn elapsed(self) -> Duration {
            Self::now().0.saturating_sub(self.0)
        }
    }

    impl Add<Duration> for Instant {
        type Output = Self;

        fn add(self, duration: Duration) -> Self {
            Self(self.0 + duration)
        }
    }
}
