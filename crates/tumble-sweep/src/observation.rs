//! What is watched in each world of a sweep, step by step: largest and least values of a body's
//! state, the first contact, and a condition that ends the world.

use tumble::hecs::Entity;
use tumble::{BodyOrder, ContactEvent, Pose, Trial, Velocity};
use tumble_record::{STATE_COLUMNS, state_numbers};

/// A number of the state of a body: its index, and that of the column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StateColumn {
    body: usize,
    column: usize,
}

/// What a column of the file is to have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Observable {
    /// The largest of all steps.
    Max(StateColumn),
    /// The smallest of all steps.
    Min(StateColumn),
    /// The time at which a body, or any two, touch first \[s\].
    FirstContact(Option<usize>),
}

/// When a world ends before its steps are done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Until {
    Below(StateColumn, f64),
    Above(StateColumn, f64),
    Contact(Option<usize>),
}

const CONTACT: &str = "first_contact";

impl Observable {
    /// Reads `max(BODY.COLUMN)`, `min(BODY.COLUMN)`, `first_contact` or `first_contact(BODY)`.
    pub(crate) fn parse(text: &str, names: &[String]) -> Result<Self, String> {
        let inside = |name: &str| text.strip_prefix(name)?.strip_prefix('(')?.strip_suffix(')');
        if let Some(of) = inside("max") {
            return StateColumn::parse(of, names).map(Self::Max);
        }
        if let Some(of) = inside("min") {
            return StateColumn::parse(of, names).map(Self::Min);
        }
        let of_contact = contact(text, names).map(|body| body.map(Self::FirstContact));
        of_contact.unwrap_or_else(|| {
            Err("is none of max(BODY.COLUMN), min(BODY.COLUMN), first_contact and first_contact(BODY)".to_owned())
        })
    }
}

impl Until {
    /// Reads `BODY.COLUMN<NUMBER`, `BODY.COLUMN>NUMBER`, `first_contact` or `first_contact(BODY)`.
    pub(crate) fn parse(text: &str, names: &[String]) -> Result<Self, String> {
        if let Some(body) = contact(text, names) {
            return body.map(Self::Contact);
        }
        let refusal =
            || "is none of BODY.COLUMN<NUMBER, BODY.COLUMN>NUMBER, first_contact and first_contact(BODY)".to_owned();
        let at = text.rfind(['<', '>']).ok_or_else(refusal)?;
        let bound: f64 = text[at + 1..].trim().parse().map_err(|_| refusal())?;
        if !bound.is_finite() {
            return Err("the bound must be finite".to_owned());
        }
        let column = StateColumn::parse(text[..at].trim(), names)?;
        Ok(if text[at..].starts_with('<') { Self::Below(column, bound) } else { Self::Above(column, bound) })
    }
}

/// The body of a first contact, if the text is one.
fn contact(text: &str, names: &[String]) -> Option<Result<Option<usize>, String>> {
    match text.strip_prefix(CONTACT)? {
        "" => Some(Ok(None)),
        of => Some(body(of.strip_prefix('(')?.strip_suffix(')')?, names).map(Some)),
    }
}

fn body(name: &str, names: &[String]) -> Result<usize, String> {
    names.iter().position(|known| known == name).ok_or_else(|| format!("the scene has no body {name:?}"))
}

impl StateColumn {
    fn parse(text: &str, names: &[String]) -> Result<Self, String> {
        let (name, column) = text.rsplit_once('.').unwrap_or((text, ""));
        let found = STATE_COLUMNS.iter().position(|known| *known == column);
        let column = found
            .ok_or_else(|| format!("a body and one of {} is needed, as in {name}.py", STATE_COLUMNS.join(", ")))?;
        Ok(Self { body: body(name, names)?, column })
    }

    #[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
    fn read(self, trial: &Trial, order: &BodyOrder) -> Option<f64> {
        let body = trial.world.entity(*order.entities().get(self.body)?).ok()?;
        let (pose, velocity) = (body.get::<&Pose>()?, body.get::<&Velocity>());
        state_numbers(&pose, velocity.as_deref()).get(self.column).copied().map(f64::from)
    }
}

/// What was seen in a world so far.
pub(crate) struct Observation<'a> {
    what: &'a [Observable],
    until: Option<Until>,
    seen: Vec<Option<f64>>,
}

impl<'a> Observation<'a> {
    /// Begins with the state at the start.
    pub(crate) fn start(what: &'a [Observable], until: Option<Until>, trial: &Trial, order: &BodyOrder) -> Self {
        let mut observation = Self { what, until, seen: vec![None; what.len()] };
        observation.see_states(trial, order);
        observation
    }

    /// Whether every step has to be seen.
    pub(crate) fn needs_every_step(&self) -> bool {
        !self.what.is_empty() || self.until.is_some()
    }

    /// Sees a step that was just done; whether it is the last.
    pub(crate) fn see(&mut self, trial: &Trial, order: &BodyOrder) -> bool {
        self.see_states(trial, order);
        for (observable, seen) in self.what.iter().zip(&mut self.seen) {
            if let Observable::FirstContact(body) = observable
                && seen.is_none()
                && is_touched(*body, trial, order)
            {
                *seen = Some(trial.simulation.time());
            }
        }
        match self.until {
            None => false,
            Some(Until::Contact(body)) => is_touched(body, trial, order),
            Some(Until::Below(column, bound)) => column.read(trial, order).is_some_and(|value| value < bound),
            Some(Until::Above(column, bound)) => column.read(trial, order).is_some_and(|value| value > bound),
        }
    }

    fn see_states(&mut self, trial: &Trial, order: &BodyOrder) {
        for (observable, seen) in self.what.iter().zip(&mut self.seen) {
            let (column, pick): (_, fn(f64, f64) -> f64) = match observable {
                Observable::Max(column) => (column, f64::max),
                Observable::Min(column) => (column, f64::min),
                Observable::FirstContact(_) => continue,
            };
            if let Some(value) = column.read(trial, order) {
                *seen = Some(seen.map_or(value, |seen| pick(seen, value)));
            }
        }
    }

    /// Of each observable; none for a contact that there was not.
    pub(crate) fn seen(self) -> Vec<Option<f64>> {
        self.seen
    }
}

/// Whether the body, or any, began to touch another in the last step.
fn is_touched(body: Option<usize>, trial: &Trial, order: &BodyOrder) -> bool {
    let entity: Option<Entity> = body.and_then(|body| order.entities().get(body).copied());
    let mut begun = trial.simulation.contact_events().filter(|event| matches!(event, ContactEvent::Begin(..)));
    begun.any(|event| body.is_none() || event.bodies().into_iter().any(|touched| Some(touched) == entity))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let names = ["a.b".to_owned(), "c".to_owned()];
        let column = |body, column| StateColumn { body, column };
        let observable = |text| Observable::parse(text, &names);
        assert_eq!(observable("max(a.b.py)"), Ok(Observable::Max(column(0, 1))));
        assert_eq!(observable("min(c.px)"), Ok(Observable::Min(column(1, 0))));
        assert_eq!(observable("first_contact"), Ok(Observable::FirstContact(None)));
        assert_eq!(observable("first_contact(c)"), Ok(Observable::FirstContact(Some(1))));
        for bad in
            ["", "max", "max(c)", "max(c.height)", "max(d.px)", "mean(c.px)", "first_contact(d)", "first_contacts"]
        {
            assert!(observable(bad).is_err(), "{bad}");
        }
        let until = |text| Until::parse(text, &names);
        assert_eq!(until("c.py < -0.5"), Ok(Until::Below(column(1, 1), -0.5)));
        assert_eq!(until("a.b.px>1e3"), Ok(Until::Above(column(0, 0), 1000.0)));
        assert_eq!(until("first_contact(a.b)"), Ok(Until::Contact(Some(0))));
        for bad in ["", "c.py", "c.py<", "c.py<inf", "c<1", "d.py<1", "c.py=1"] {
            assert!(until(bad).is_err(), "{bad}");
        }
    }
}
