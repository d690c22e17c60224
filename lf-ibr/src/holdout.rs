//! Leaving cameras of a slab out, to see how well the others predict them.

use glam::Vec2;
use lf_math::{Coverage, GeometryError, SampledAxis, Slab, SlabTexels, Windows};

use crate::texel::Texel;

/// A slab with cameras left out of its grid.
#[derive(Debug, Clone)]
pub struct HoldOut<T = [u8; 4]> {
    /// The slab of the cameras that are kept.
    pub slab: Slab,
    /// Their texels.
    pub texels: SlabTexels<T>,
    /// The cameras with an image that were left out, in the order of the whole slab.
    pub views: Vec<LeftOut>,
}

/// A camera that was left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeftOut {
    /// Its indices in the whole slab.
    pub camera: [u32; 2],
    /// Where it stands between the cameras that are kept, in their indices.
    pub place: Vec2,
}

/// Keeps every n-th camera along s and along t, beginning with the first; the others are left out. Those beyond the last that is kept
/// are neither: nothing is to be guessed beyond the grid.
///
/// # Errors
/// Steps must be at least 1, and the texels those of the slab.
pub fn hold_out<T: Texel>(slab: &Slab, texels: &SlabTexels<T>, steps: [u32; 2]) -> Result<HoldOut<T>, GeometryError> {
    texels.check(slab)?;
    if steps.contains(&0) {
        return Err(GeometryError::ZeroCount { what: "cameras from one that is kept to the next" });
    }
    let thinned = |i: usize| {
        let axis = slab.st()[i];
        // A single camera keeps its step: it is no distance to another.
        let step = if axis.count() > steps[i] { axis.step() * steps[i] as f32 } else { axis.step() };
        SampledAxis::new(axis.first(), step, axis.count().div_ceil(steps[i]))
    };
    let kept = Slab::new(slab.face(), slab.plane(), [thinned(0)?, thinned(1)?], slab.uv(), slab.focal_depth())?;
    let last = [0, 1].map(|i| (kept.cameras()[i] - 1) * steps[i]);
    let between =
        |camera: &[u32; 2]| (0..2).all(|i| camera[i] <= last[i]) && (0..2).any(|i| !camera[i].is_multiple_of(steps[i]));
    let place = |[s, t]: [u32; 2]| Vec2::new(s as f32 / steps[0] as f32, t as f32 / steps[1] as f32);
    let stored = texels.coverage().stored().map(|(camera, _)| camera).filter(between);
    let views = stored.map(|camera| LeftOut { camera, place: place(camera) }).collect();
    Ok(HoldOut { texels: thin(&kept, texels, steps)?, slab: kept, views })
}

/// The texels of every n-th camera.
fn thin<T: Texel>(kept: &Slab, texels: &SlabTexels<T>, steps: [u32; 2]) -> Result<SlabTexels<T>, GeometryError> {
    let whole = texels.coverage();
    let windows = |axis: &Windows, step: u32| axis.iter().step_by(step as usize).collect();
    let (columns, rows) = (windows(whole.columns(), steps[0]), windows(whole.rows(), steps[1]));
    let coverage = Coverage::new(kept, columns, rows)?;
    let image = |[s, t]: [u32; 2]| texels.image([s * steps[0], t * steps[1]]);
    let there = coverage.cameras().map(|camera| image(camera).is_some()).collect();
    let coverage = coverage.with_cameras(there)?;
    let all =
        coverage.stored().filter_map(|(camera, _)| image(camera)).flat_map(|image| image.texels).copied().collect();
    SlabTexels::covering(coverage, all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lf_math::Face;

    fn slab(cameras: [u32; 2]) -> Slab {
        let st = cameras.map(|count| SampledAxis::new(-1.0, 0.25, count).unwrap());
        let uv = [4, 3].map(|count| SampledAxis::spanning(-1.0, 1.0, count).unwrap());
        Slab::new(Face::PosY, 0.5, st, uv, Some(2.0)).unwrap()
    }

    /// Each texel tells its camera.
    fn texels(slab: &Slab) -> SlabTexels {
        let [s, t] = slab.cameras();
        let cameras = (0..t).flat_map(|t| (0..s).map(move |s| [s as u8, t as u8, 0, 255]));
        SlabTexels::new(slab, cameras.flat_map(|texel| [texel; 12]).collect()).unwrap()
    }

    #[test]
    fn every_second_camera_keeps_its_place_and_its_image() {
        let slab = slab([6, 5]);
        let held = hold_out(&slab, &texels(&slab), [2, 2]).unwrap();
        assert_eq!(held.slab.cameras(), [3, 3]);
        assert_eq!(held.slab.focal_depth(), slab.focal_depth());
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let place =
                |slab: &Slab, k: [u32; 2]| slab.sample_ray(Vec2::new(k[0] as f32, k[1] as f32), Vec2::ZERO).origin;
            assert_eq!(place(&held.slab, [i, j]), place(&slab, [2 * i, 2 * j]));
            assert_eq!(held.texels.texel([i, j], [3, 2]), Some([2 * i as u8, 2 * j as u8, 0, 255]));
        }
        // Of 5×5 cameras up to the last that is kept; the sixth column is beyond it.
        assert_eq!(held.views.len(), 25 - 9);
        let middle = held.views.iter().find(|view| view.camera == [3, 2]).unwrap();
        assert_eq!(middle.place, Vec2::new(1.5, 1.0));
    }

    #[test]
    fn missing_cameras_are_neither_kept_nor_asked_for() {
        let slab = slab([5, 3]);
        let kept = (0..15).map(|camera| camera != 2 && camera != 6).collect();
        let texels = texels(&slab).crop(Coverage::whole(&slab).with_cameras(kept).unwrap()).unwrap();
        let held = hold_out(&slab, &texels, [2, 2]).unwrap();
        assert!(held.texels.image([1, 0]).is_none() && held.texels.image([1, 1]).is_some());
        assert!(held.views.iter().all(|view| view.camera != [1, 1]));
        assert_eq!(held.views.len(), 15 - 6 - 1);
    }

    #[test]
    fn a_single_row_stays() {
        let slab = slab([7, 1]);
        let held = hold_out(&slab, &texels(&slab), [3, 3]).unwrap();
        assert_eq!((held.slab.cameras(), held.views.len()), ([3, 1], 4));
        assert!(hold_out(&slab, &texels(&slab), [0, 1]).is_err());
    }
}
