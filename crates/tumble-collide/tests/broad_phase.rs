//! Promise: the broad phase finds all pairs that are near each other, in order, each once, however
//! the objects moved before, and none of two that do not move.
//!
//! Why: a pair it misses falls through the floor, one it has twice is pushed twice, and an order of
//! its own making would be another result on another day. Every history is compared with what all
//! pairs, asked one by one, give.

use proptest::prelude::*;
use tumble_collide::{Aabb, BroadPhase, Proxy, Scalar};
use tumble_math::lane::Vec3;

/// What happens between two updates.
#[derive(Clone, Debug)]
enum Event {
    /// Every object that moves goes its way.
    Go,
    /// They tremble by less than their boxes are larger.
    Tremble,
    /// One is somewhere else, of another size.
    Jump { which: prop::sample::Index, to: Object },
    /// One is no longer a box: no number, endless in a direction, inside out.
    Break { which: prop::sample::Index, how: u8 },
    /// Some of them are in one place.
    Gather { every: usize },
    /// Everything flies apart or together.
    Scale { by: f64 },
    /// Other objects in another number, with or without a word.
    Begin { objects: Vec<Object>, reset: bool },
    /// What moves does not any longer, and the other way round.
    Swap { which: prop::sample::Index },
}

#[derive(Clone, Copy, Debug)]
struct Object {
    center: [f64; 3],
    half: [f64; 3],
    way: [f64; 3],
    endless: bool,
    moves: bool,
}

fn object() -> impl Strategy<Value = Object> {
    let near = || -4.0..4.0_f64;
    let size = prop_oneof![20 => 0.05..0.7_f64, 4 => Just(0.5), 1 => Just(0.0), 1 => 10.0..1e5_f64];
    let way = prop_oneof![2 => Just(0.0), 3 => -0.02..0.02_f64, 1 => -0.6..0.6_f64];
    let center = prop_oneof![20 => [near(), near(), near()], 1 => [-1e8..1e8_f64, near(), near()]];
    let flags = (prop::bool::weighted(0.04), prop::bool::weighted(0.75));
    (center, [size.clone(), size.clone(), size], [way.clone(), way.clone(), way], flags)
        .prop_map(|(center, half, way, (endless, moves))| Object { center, half, way, endless, moves })
}

fn objects() -> impl Strategy<Value = Vec<Object>> {
    prop_oneof![prop::collection::vec(object(), 0..40), prop::collection::vec(object(), 60..160)]
}

fn event() -> impl Strategy<Value = Event> {
    let which = any::<prop::sample::Index>;
    prop_oneof![
        12 => Just(Event::Go),
        3 => Just(Event::Tremble),
        2 => (which(), object()).prop_map(|(which, to)| Event::Jump { which, to }),
        1 => (which(), 0..4_u8).prop_map(|(which, how)| Event::Break { which, how }),
        1 => (1..9_usize).prop_map(|every| Event::Gather { every }),
        1 => prop_oneof![0.3..1.0, 1.0..4.0, Just(0.0)].prop_map(|by| Event::Scale { by }),
        1 => (objects(), any::<bool>()).prop_map(|(objects, reset)| Event::Begin { objects, reset }),
        1 => which().prop_map(|which| Event::Swap { which }),
    ]
}

fn proxy<R: Scalar>(object: &Object) -> Proxy<R> {
    let vector = |v: [f64; 3]| Vec3::new(R::splat(v[0]), R::splat(v[1]), R::splat(v[2]));
    let aabb = Aabb::about(vector(object.center), vector(object.half));
    Proxy { aabb: (!object.endless).then_some(aabb), moves: object.moves }
}

fn happen(event: &Event, objects: &mut Vec<Object>) {
    match event {
        Event::Go | Event::Tremble => {
            let part = if matches!(event, Event::Go) { 1.0 } else { 1e-3 };
            for object in objects.iter_mut().filter(|object| object.moves) {
                (0..3).for_each(|axis| object.center[axis] += part * object.way[axis]);
            }
        }
        Event::Jump { which, to } if !objects.is_empty() => *which.get_mut(objects) = *to,
        Event::Break { which, how } if !objects.is_empty() => {
            let object = which.get_mut(objects);
            match how {
                0 => object.center[1] = f64::NAN,
                1 => object.half[2] = f64::INFINITY,
                2 => object.half[0] = -1.0,
                _ => object.center[2] = f64::INFINITY,
            }
        }
        Event::Gather { every } => objects.iter_mut().step_by(*every).for_each(|object| object.center = [0.5; 3]),
        Event::Scale { by } => objects.iter_mut().for_each(|object| object.center = object.center.map(|x| x * by)),
        Event::Begin { objects: others, .. } => objects.clone_from(others),
        Event::Swap { which } if !objects.is_empty() => {
            let object = which.get_mut(objects);
            object.moves = !object.moves;
        }
        _ => {}
    }
}

fn wanted(first: u32, second: u32) -> bool {
    !(first + second).is_multiple_of(7)
}

/// Every pair, asked.
fn all_near<R: Scalar>(proxies: &[Proxy<R>]) -> Vec<(u32, u32)> {
    let pairs = (0..proxies.len()).flat_map(|a| (a + 1..proxies.len()).map(move |b| (a, b)));
    let near = pairs.filter(|(a, b)| proxies[*a].is_near(&proxies[*b])).map(|(a, b)| (a as u32, b as u32));
    near.filter(|(a, b)| wanted(*a, *b)).collect()
}

fn check<R: Scalar>(start: &[Object], events: &[Event]) -> Result<(), TestCaseError> {
    let mut objects = start.to_vec();
    let mut broad_phase = BroadPhase::<R>::default();
    let mut limited = BroadPhase::<R>::default();
    for (step, event) in std::iter::once(&Event::Tremble).chain(events).enumerate() {
        happen(event, &mut objects);
        if matches!(event, Event::Begin { reset: true, .. }) {
            broad_phase.reset();
            limited.reset();
        }
        let proxies: Vec<Proxy<R>> = objects.iter().map(proxy).collect();
        let found = broad_phase.update(&proxies, wanted).to_vec();
        prop_assert_eq!(&found, broad_phase.pairs());
        prop_assert!(found.is_sorted_by(|a, b| a < b), "step {}: not in order, or twice: {:?}", step, found);
        for (first, second) in &found {
            let [a, b] = [first, second].map(|index| &proxies[*index as usize]);
            prop_assert!(first < second && (a.moves || b.moves) && wanted(*first, *second), "{:?}", (first, second));
        }
        let mut near = found;
        near.retain(|(a, b)| proxies[*a as usize].is_near(&proxies[*b as usize]));
        prop_assert_eq!(near, all_near(&proxies), "step {}", step);
        let most = 40 * (step % 3);
        let mut near = match limited.update_within(&proxies, most, wanted) {
            Some(found) => {
                let with_end = found.iter().filter(|(a, b)| !endless(&proxies, *a) && !endless(&proxies, *b)).count();
                prop_assert!(with_end <= most, "{} of {}", with_end, most);
                found.to_vec()
            }
            None => {
                let mut found = Vec::new();
                limited.for_each_pair(&proxies, wanted, |a, b| found.push((a, b)));
                found.sort_unstable();
                prop_assert!(found.is_sorted_by(|a, b| a < b), "step {}: twice: {:?}", step, found);
                found
            }
        };
        near.retain(|(a, b)| proxies[*a as usize].is_near(&proxies[*b as usize]));
        prop_assert_eq!(near, all_near(&proxies), "step {}, at most {}", step, most);
    }
    Ok(())
}

fn endless<R>(proxies: &[Proxy<R>], index: u32) -> bool {
    proxies[index as usize].aabb.is_none()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_500))]

    #[test]
    fn whatever_happened_all_that_is_near_is_found(start in objects(), events in prop::collection::vec(event(), 1..25)) {
        check::<f32>(&start, &events)?;
        check::<f64>(&start, &events)?;
    }
}

/// From nothing the only others are those within the room of a box, 2.5 cm to every side. While all
/// move, an object is anywhere in its box, which has that room on both sides and four steps of the
/// way it went before.
#[test]
fn not_much_else_is_found() {
    const ROOM: f64 = 0.025;
    const ROUNDING: f64 = 1e-12;
    let place = |i: u32| [i % 12, i / 12 % 12, i / 144].map(|place| 1.1 * f64::from(place));
    let way = |i: u32| [i * 7 % 11, i * 5 % 13, i * 3 % 7].map(|way| 0.002 * f64::from(way));
    let longest = 0.024;
    let mut objects: Vec<Object> = (0..1728)
        .map(|i| Object { center: place(i), half: [0.54; 3], way: way(i), endless: false, moves: true })
        .collect();
    let with_room = |objects: &[Object], room: f64| {
        let larger =
            |object: &Object| proxy(&Object { half: object.half.map(|half| half + room + ROUNDING), ..*object });
        all_near::<f64>(&objects.iter().map(larger).collect::<Vec<_>>())
    };
    let mut broad_phase = BroadPhase::<f64>::default();
    for step in 0..60 {
        let proxies: Vec<Proxy<f64>> = objects.iter().map(proxy).collect();
        let found = broad_phase.update(&proxies, wanted);
        if step == 0 {
            assert!(all_near(&proxies).is_empty());
            assert_eq!(found, with_room(&objects, ROOM));
        } else {
            let near = with_room(&objects, 2.0 * ROOM + 4.0 * longest);
            let other = found.iter().find(|pair| near.binary_search(pair).is_err());
            assert_eq!(other, None, "step {step}");
        }
        objects.iter_mut().for_each(|object| (0..3).for_each(|axis| object.center[axis] += object.way[axis]));
    }
}
