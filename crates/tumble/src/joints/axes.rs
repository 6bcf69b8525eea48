//! Sets of the six axes of a joint.

use std::ops::{BitAnd, BitOr};

/// A set of the six axes along and about which one body of a joint can move against the other:
/// three of translation and three of rotation.
///
/// ```
/// use tumble::Axes;
///
/// let cylinder = Axes::LINEAR_X | Axes::ANGULAR_X;
/// assert!(cylinder.contains(Axes::ANGULAR_X) && !cylinder.contains(Axes::LINEAR_Y));
/// assert_eq!(cylinder.count(), 2);
/// assert_eq!(cylinder & Axes::LINEAR, Axes::LINEAR_X);
/// let free = Axes::EACH.into_iter().filter(|axis| cylinder.contains(*axis));
/// assert_eq!(free.collect::<Axes>(), cylinder);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Axes(u8);

impl Axes {
    /// No axis: all are locked.
    pub const NONE: Self = Self(0);
    /// Translation along x of the joint's frame.
    pub const LINEAR_X: Self = Self(1);
    /// Translation along y.
    pub const LINEAR_Y: Self = Self(1 << 1);
    /// Translation along z.
    pub const LINEAR_Z: Self = Self(1 << 2);
    /// Rotation about x: the hinge's axis, and that of twist.
    pub const ANGULAR_X: Self = Self(1 << 3);
    /// Rotation about y.
    pub const ANGULAR_Y: Self = Self(1 << 4);
    /// Rotation about z.
    pub const ANGULAR_Z: Self = Self(1 << 5);
    /// Each axis alone, in the order of [`JointLoad::values`](crate::JointLoad::values).
    pub const EACH: [Self; 6] =
        [Self::LINEAR_X, Self::LINEAR_Y, Self::LINEAR_Z, Self::ANGULAR_X, Self::ANGULAR_Y, Self::ANGULAR_Z];
    /// All translations.
    pub const LINEAR: Self = Self(0b111);
    /// All rotations.
    pub const ANGULAR: Self = Self(0b11_1000);

    /// Whether all axes of another set are in this one.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The union with another set.
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// How many there are, from 0 to 6.
    pub const fn count(self) -> u32 {
        self.0.count_ones()
    }

    /// Whether the axis of this index is among them: `x y z` of translation, then of rotation.
    pub(crate) const fn has(self, index: usize) -> bool {
        self.0 & (1 << index) != 0
    }

    /// All others.
    pub(crate) const fn others(self) -> Self {
        Self(!self.0 & 0b11_1111)
    }

    /// One bit per axis, in the order of [`EACH`](Self::EACH) from the lowest on.
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// The set of these [`bits`](Self::bits); `None` where a bit is set that no axis has.
    ///
    /// ```
    /// # use tumble::Axes;
    /// assert_eq!(Axes::from_bits(0b1000), Some(Axes::ANGULAR_X));
    /// assert_eq!(Axes::from_bits(64), None);
    /// ```
    pub const fn from_bits(bits: u8) -> Option<Self> {
        if bits & !0b11_1111 == 0 { Some(Self(bits)) } else { None }
    }
}

/// The union of two sets.
impl BitOr for Axes {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        self.with(other)
    }
}

/// What two sets have in common.
impl BitAnd for Axes {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

/// The union of all sets.
impl FromIterator<Axes> for Axes {
    fn from_iter<I: IntoIterator<Item = Axes>>(sets: I) -> Self {
        sets.into_iter().fold(Self::NONE, Self::with)
    }
}
