//! One of two peers: plays on with what it guesses of the other, and corrects itself when it hears.

use hecs::World;
use tumble::{BodyOrder, Rollback, RollbackError, Settings, Simulation, SnapshotError, state_hash};

use crate::game::{self, Input, Inputs, Trigger};
use crate::wire::{Message, Wire};

/// Whatever goes wrong.
pub(crate) type Failure = Box<dyn std::error::Error>;

/// What correcting took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Corrections {
    /// How often the peer went back.
    pub(crate) rewinds: u64,
    /// The furthest that it went back, in steps.
    pub(crate) longest: u64,
    /// Steps that were taken again.
    pub(crate) steps_again: u64,
    /// Bodies that were spawned in steps that were taken back.
    pub(crate) despawned: usize,
    /// Bodies that were despawned in steps that were taken back.
    pub(crate) respawned: usize,
    /// Hashes of the other peer that were compared, and were the same.
    pub(crate) checks: u64,
}

pub(crate) struct Peer {
    /// 0 or 1.
    player: usize,
    world: World,
    simulation: Simulation,
    rollback: Rollback,
    /// The inputs of all steps so far, as they were played.
    played: Vec<Inputs>,
    /// What the other player did, as far as it is known.
    heard: Vec<Option<Input>>,
    /// Hashes that the other sent, of steps that are not known here yet.
    checks: Vec<(u64, u64)>,
    pub(crate) corrections: Corrections,
}

impl Peer {
    pub(crate) fn new(player: usize) -> Result<Self, Failure> {
        Ok(Self {
            player,
            world: game::start()?,
            simulation: Simulation::new(Settings::default())?,
            // As far as a message can be late, and the hash of the other that comes with it.
            rollback: Rollback::new(2 * Wire::LONGEST_DELAY as usize + 2),
            played: Vec::new(),
            heard: Vec::new(),
            checks: Vec::new(),
            corrections: Corrections::default(),
        })
    }

    /// Takes a step with the player's input, and the best guess of what the other does.
    pub(crate) fn play(&mut self, input: Input) -> Result<Message, Failure> {
        let step = self.simulation.steps();
        let mut inputs = Inputs::default();
        inputs[self.player] = input;
        inputs[1 - self.player] = self.guess(step);
        self.played.push(inputs);
        self.take_step()?;
        let known = self.known();
        let check = self.rollback.at_step(known).map(|snapshot| (known, snapshot.state_hash()));
        Ok(Message { step, input, check })
    }

    /// Hears of the other's inputs, goes back to the first that was not as guessed, and takes the
    /// steps since again.
    pub(crate) fn hear(&mut self, messages: Vec<Message>) -> Result<(), Failure> {
        let now = self.simulation.steps();
        for message in messages {
            let step = message.step as usize;
            self.heard.resize(self.heard.len().max(step + 1), None);
            self.heard[step] = Some(message.input);
            self.checks.extend(message.check);
        }
        let other = 1 - self.player;
        // Guesses are made again too: an input that is heard changes what is guessed of those after
        // it.
        let wrong = (0..now).find(|&step| self.played[step as usize][other] != self.guess(step));
        if let Some(wrong) = wrong {
            self.go_back_to(wrong)?;
            while self.simulation.steps() < now {
                let step = self.simulation.steps();
                self.played[step as usize][other] = self.guess(step);
                self.take_step()?;
            }
            self.corrections.rewinds += 1;
            self.corrections.longest = self.corrections.longest.max(now - wrong);
            self.corrections.steps_again += now - wrong;
        }
        self.compare()
    }

    /// The hash of the state, once the other has been heard to the end.
    pub(crate) fn hash(&self) -> u64 {
        state_hash(&self.world, &BodyOrder::of(&self.world))
    }

    /// Saves the start of the step and takes it.
    fn take_step(&mut self) -> Result<(), Failure> {
        self.rollback.save(&self.world, &self.simulation)?;
        let inputs = self.played[self.simulation.steps() as usize];
        Ok(game::step(&mut self.world, &mut self.simulation, &inputs)?)
    }

    /// What the other is known to have done or, where that is not known, what it did last, with the
    /// trigger loose.
    fn guess(&self, step: u64) -> Input {
        let until = self.heard.len().min(step as usize + 1);
        if let Some(Some(known)) = self.heard.get(step as usize) {
            return *known;
        }
        let last = self.heard[..until].iter().rev().flatten().next().copied().unwrap_or_default();
        Input { trigger: Trigger::Loose, ..last }
    }

    /// The step up to whose start all inputs are known.
    fn known(&self) -> u64 {
        self.heard.iter().take_while(|input| input.is_some()).count() as u64
    }

    /// Rewinds. A snapshot cannot make bodies that are gone: they are spawned again and then put
    /// where they were.
    fn go_back_to(&mut self, step: u64) -> Result<(), Failure> {
        let mut rewound = self.rollback.rewind_to_step(step, &mut self.world, &mut self.simulation);
        if let Err(RollbackError::Snapshot(SnapshotError::Missing { ids })) = &rewound {
            for &id in ids {
                game::body(id)?.spawn(&mut self.world);
            }
            self.corrections.respawned += ids.len();
            rewound = self.rollback.rewind_to_step(step, &mut self.world, &mut self.simulation);
        }
        let spawned_since = rewound?;
        self.corrections.despawned += spawned_since.len();
        for body in spawned_since {
            self.world.despawn(body)?;
        }
        Ok(())
    }

    /// Compares the other's hashes with the peer's own of the same steps, once all that led there
    /// is known.
    fn compare(&mut self) -> Result<(), Failure> {
        let known = self.known();
        for (step, theirs) in self.checks.extract_if(.., |(step, _)| *step <= known) {
            // What is too long ago was compared with another message, or is not kept.
            let Some(ours) = self.rollback.at_step(step) else { continue };
            if ours.state_hash() != theirs {
                return Err(format!("the peers differ since step {step}").into());
            }
            self.corrections.checks += 1;
        }
        Ok(())
    }
}
