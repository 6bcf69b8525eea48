//! What a bench is about, made only where the bench is run.

/// A value that is made when it is first needed: a bench that a filter leaves out, or that is only
/// listed, makes no world.
#[derive(Debug)]
pub struct OnDemand<T, F> {
    make: F,
    made: Option<T>,
}

impl<T, F: FnMut() -> T> OnDemand<T, F> {
    /// Nothing is made yet.
    pub const fn new(make: F) -> Self {
        Self { make, made: None }
    }

    /// The value, which is made by the first call.
    pub fn get(&mut self) -> &mut T {
        self.made.get_or_insert_with(&mut self.make)
    }
}
