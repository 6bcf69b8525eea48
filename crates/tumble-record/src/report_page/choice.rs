//! Which bodies of many are shown.

/// Bodies that no force moves are scenery, of which this many are shown before the others.
const MAX_SCENERY: usize = 100;
/// The fractional part of the golden ratio in 2^32: multiples of it are spread evenly over whole
/// turns.
const GOLDEN: u32 = 2_654_435_769;

/// The indices of at most `most` bodies of `count`, in order: scenery first, then the others,
/// spread over them all.
///
/// One is taken of each of equally many neighbours, each time at another place among them, for
/// kinds of bodies often alternate and every tenth may be a ball.
pub(crate) fn choose(count: usize, most: usize, is_scenery: impl Fn(usize) -> bool) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let (scenery, mut others): (Vec<usize>, Vec<usize>) = (0..count).partition(|&index| is_scenery(index));
    let shown = scenery.len().min(MAX_SCENERY).min(most);
    let (scenery, left) = scenery.split_at(shown);
    others.extend(left);
    let room = (most - shown).min(others.len());
    let place = |part: usize| {
        let within = u64::from((part as u32).wrapping_mul(GOLDEN));
        // Below `others.len()`, as part < room and within < 2^32.
        (((part as u128) << 32 | u128::from(within)) * others.len() as u128 / ((room as u128) << 32)) as usize
    };
    // Where most are chosen, two parts may come to the same place.
    let mut next = 0;
    let places = (0..room).map(|part| {
        let at = place(part).clamp(next, others.len() - (room - part));
        next = at + 1;
        at
    });
    let mut chosen: Vec<usize> = places.filter_map(|at| others.get(at).copied()).collect();
    chosen.extend(scenery);
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_bodies_are_all_shown() {
        assert_eq!(choose(3, 3, |_| false), [0, 1, 2]);
        assert!(choose(0, 3, |_| true).is_empty());
    }

    #[test]
    fn of_many_there_are_some_from_everywhere_and_of_every_kind() {
        let chosen = choose(10_000, 1000, |_| false);
        assert_eq!(chosen.len(), 1000);
        assert!(chosen.iter().enumerate().all(|(part, &index)| index / 10 == part), "one of each ten");
        for kind in 0..10 {
            let of_kind = chosen.iter().filter(|&&index| index % 10 == kind).count();
            // A hundred each, but for what does not come out even.
            assert!((90..=110).contains(&of_kind), "{of_kind} of kind {kind}");
        }
    }

    #[test]
    fn all_but_a_few_are_different_ones() {
        for count in [1001, 1100, 1500, 1999, 2001] {
            let chosen = choose(count, 1000, |index| index == 7);
            assert!(chosen.len() == 1000 && chosen.is_sorted_by(|a, b| a < b) && chosen[999] < count, "{count}");
        }
    }

    #[test]
    fn scenery_is_shown_before_others() {
        let chosen = choose(5000, 1000, |index| index >= 4980);
        assert_eq!((chosen.len(), chosen.iter().filter(|&&index| index >= 4980).count()), (1000, 20));
        // Of nothing but scenery there is as much as of anything.
        assert_eq!(choose(5000, 1000, |_| true).len(), 1000);
    }
}
