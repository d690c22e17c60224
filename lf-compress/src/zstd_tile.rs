//! One zstd frame per tile, as clause 7.5 of the file format asks.

use std::io;

use zstd::zstd_safe::{self, CParameter};

/// A middle level: up to 15 the next ones gain almost nothing on BC1.
pub(crate) const LEVEL: i32 = 9;
/// Gains a tenth over [`LEVEL`] at many times the time: for tiles that zstd suits.
pub(crate) const HIGH_LEVEL: i32 = 19;
/// How a frame begins; a skippable one does not.
const MAGIC: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];
/// Largest window of a frame: 8 MiB.
pub(crate) const MAX_WINDOW_LOG: u32 = 23;

/// Packs a tile into one frame that states its content size.
pub(crate) fn pack(raw: &[u8], level: i32) -> io::Result<Vec<u8>> {
    let mut compressor = zstd::bulk::Compressor::new(level)?;
    if raw.len() > 1 << MAX_WINDOW_LOG {
        compressor.set_parameter(CParameter::WindowLog(MAX_WINDOW_LOG))?;
    }
    compressor.compress(raw)
}

/// Unpacks one frame that must hold exactly as many bytes as `out`.
///
/// Size and window are compared first, so a hostile frame costs nothing but time.
pub(crate) fn unpack_into(frame: &[u8], out: &mut [u8]) -> Result<(), String> {
    let len = out.len();
    let stated = check(frame)?;
    if stated != len as u64 {
        return Err(format!("is a zstd frame that states {stated} instead of {len} bytes"));
    }
    let unpacked = zstd::bulk::Decompressor::new().and_then(|mut zstd| zstd.decompress_to_buffer(frame, out));
    let found = unpacked.map_err(|e| format!("does not unpack: {e}"))?;
    if found == len { Ok(()) } else { Err(format!("unpacks to {found} instead of {len} bytes")) }
}

/// Unpacks exactly one frame that states a content size of at most `limit` bytes. The result has room for `slack` more.
pub(crate) fn unpack_up_to(frame: &[u8], limit: u64, slack: usize) -> Result<Vec<u8>, String> {
    let stated = check(frame)?;
    if stated > limit {
        return Err(format!("is a zstd frame that states {stated} bytes, must state at most {limit}"));
    }
    let stated = usize::try_from(stated).map_err(|_| "does not fit in memory".to_owned())?;
    let mut raw = Vec::with_capacity(stated.saturating_add(slack));
    let unpacked = zstd::bulk::Decompressor::new().and_then(|mut zstd| zstd.decompress_to_buffer(frame, &mut raw));
    let found = unpacked.map_err(|e| format!("does not unpack: {e}"))?;
    if found == stated { Ok(raw) } else { Err(format!("unpacks to {found} instead of {stated} bytes")) }
}

/// Holds a frame to clause 7.5 of the file format, and returns the content size that it states.
fn check(frame: &[u8]) -> Result<u64, String> {
    if frame.first_chunk() != Some(&MAGIC) {
        return Err("is not a zstd frame".to_owned());
    }
    let stated = content_size(frame)?.ok_or("is a zstd frame that does not state its size")?;
    if window_size(frame, stated).is_none_or(|window| window > 1 << MAX_WINDOW_LOG) {
        return Err("is a zstd frame with a window of more than 8 MiB".to_owned());
    }
    if zstd_safe::get_dict_id_from_frame(frame).is_some() {
        return Err("is a zstd frame that needs a dictionary".to_owned());
    }
    let frame_len = zstd_safe::find_frame_compressed_size(frame).map_err(|_| "is a broken zstd frame".to_owned())?;
    if frame_len != frame.len() {
        return Err(format!("has {} bytes after its zstd frame", frame.len() - frame_len));
    }
    Ok(stated)
}

fn content_size(frame: &[u8]) -> Result<Option<u64>, String> {
    zstd_safe::get_frame_content_size(frame).map_err(|_| "is not a zstd frame".to_owned())
}

/// The window that a frame asks for (RFC 8878, 3.1.1.1.2): the content size of a single-segment frame, else
/// (8 + mantissa)/8 · 2^(10 + exponent).
fn window_size(frame: &[u8], content_size: u64) -> Option<u64> {
    let single_segment = frame.get(4)? & 0x20 != 0;
    let descriptor = u64::from(*frame.get(5)?);
    let (exponent, mantissa) = (descriptor >> 3, descriptor & 7);
    Some(if single_segment { content_size } else { (8 + mantissa) << (7 + exponent) })
}

#[cfg(test)]
mod tests {
    use super::*;

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    fn unpack(frame: &[u8], len: usize) -> Result<Vec<u8>, String> {
        let mut out = vec![0; len];
        unpack_into(frame, &mut out).map(|()| out)
    }

    fn sample(len: u32) -> Vec<u8> {
        (0..len).map(|i| (i.wrapping_mul(i) >> 7) as u8).collect()
    }

    #[test]
    fn frames_round_trip_and_anything_else_is_refused() -> Outcome {
        let raw = sample(10_000);
        let frame = pack(&raw, LEVEL)?;
        assert_eq!(unpack(&frame, raw.len()), Ok(raw.clone()));
        assert!(unpack(&frame, raw.len() - 1).is_err());
        assert!(unpack(&frame[..frame.len() - 1], raw.len()).is_err());
        assert!(unpack(&[frame.as_slice(), &[0]].concat(), raw.len()).is_err());
        assert!(unpack(&[frame.as_slice(), &frame].concat(), raw.len()).is_err());
        let skippable = [&[0x50, 0x2A, 0x4D, 0x18, 4, 0, 0, 0, 1, 2, 3, 4], frame.as_slice()].concat();
        assert!(unpack(&skippable, raw.len()).is_err());
        assert!(unpack(b"not zstd", raw.len()).is_err());
        assert!(unpack(&[], raw.len()).is_err());
        Ok(())
    }

    #[test]
    fn frames_without_size_or_with_large_windows_are_refused() -> Outcome {
        let raw = sample(9 << 20);
        let frame = pack(&raw, LEVEL)?;
        assert_eq!(window_size(&frame, raw.len() as u64), Some(8 << 20));
        assert_eq!(unpack(&frame, raw.len()).map(|raw| raw.len()), Ok(9 << 20));
        let wide = zstd::bulk::compress(&raw, 1)?;
        let mut compressor = zstd::bulk::Compressor::new(1)?;
        compressor.set_parameter(CParameter::WindowLog(27))?;
        for frame in [wide, compressor.compress(&raw)?] {
            let asks = window_size(&frame, raw.len() as u64);
            assert_eq!(unpack(&frame, raw.len()).is_err(), asks > Some(8 << 20), "{asks:?}");
        }
        compressor.set_parameter(CParameter::ContentSizeFlag(false))?;
        assert!(unpack(&compressor.compress(&raw[..1000])?, 1000).is_err());
        Ok(())
    }
}
