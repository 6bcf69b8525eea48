//! Bytes of snapshots that nobody has saved.

/// The bytes with others in a place, and a checksum that fits: 64-bit FNV-1a, written here once
/// more.
///
/// # Panics
/// Where there are fewer bytes than that.
pub fn forged(bytes: &[u8], place: usize, other: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[place..place + other.len()].copy_from_slice(other);
    let end = bytes.len() - 8;
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    let sum = bytes[..end].iter().fold(0xcbf2_9ce4_8422_2325, step);
    bytes[end..].copy_from_slice(&sum.to_le_bytes());
    bytes
}
