//! Reuse the planes of earlier pictures, because allocating memory takes much of the time of a
//! small picture.

use super::{Frame, NamedPlane, Plane, Samples};

/// Planes of finished pictures, ready for the next picture.
///
/// A plane taken from the pool holds any values, those of an earlier picture or 0, so the caller
/// must write every pixel.
#[derive(Debug, Default)]
pub struct Pool {
    scalars: Vec<Plane<f32>>,
    triples: Vec<Plane<[f32; 3]>>,
    indices: Vec<Plane<u32>>,
    counts: Vec<Plane<u8>>,
}

impl Pool {
    /// Takes the planes of a picture that is no longer needed.
    pub fn recycle(&mut self, frame: Frame<f32>) {
        for NamedPlane { samples, .. } in frame.planes {
            match samples {
                Samples::Scalar(plane) => self.scalars.push(plane),
                Samples::Color(plane) | Samples::Vector(plane) => self.triples.push(plane),
                Samples::Index(plane) => self.indices.push(plane),
                Samples::Count(plane) => self.counts.push(plane),
            }
        }
    }

    /// A plane of numbers.
    pub fn scalar(&mut self, size: [u32; 2]) -> Plane<f32> {
        take(&mut self.scalars, size)
    }

    /// A plane of colours or vectors.
    pub fn triple(&mut self, size: [u32; 2]) -> Plane<[f32; 3]> {
        take(&mut self.triples, size)
    }

    /// A plane of indices.
    pub fn index(&mut self, size: [u32; 2]) -> Plane<u32> {
        take(&mut self.indices, size)
    }

    /// A plane of counts.
    pub fn count(&mut self, size: [u32; 2]) -> Plane<u8> {
        take(&mut self.counts, size)
    }

    /// Drops the planes that the last picture did not take, so that a session never holds more than
    /// the planes of two pictures.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

/// Takes a plane of this size, and drops planes of other sizes on the way.
fn take<T: Copy + Default>(planes: &mut Vec<Plane<T>>, [width, height]: [u32; 2]) -> Plane<T> {
    while let Some(plane) = planes.pop() {
        if (plane.width(), plane.height()) == (width, height) {
            return plane;
        }
    }
    Plane::filled(width, height, T::default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_of_the_size_is_used_again_and_others_are_dropped() {
        let mut pool = Pool::default();
        let planes = [3, 4].map(|width| NamedPlane {
            name: width.to_string(),
            samples: Samples::Scalar(Plane::filled(width, 2, 7.0)),
        });
        pool.recycle(Frame { width: 3, height: 2, planes: planes.into() });
        let again = pool.scalar([3, 2]);
        assert_eq!((again.width(), again.at(2, 1)), (3, &7.0), "its memory, its values");
        assert_eq!(pool.scalar([3, 2]).at(0, 0), &0.0, "there was only one");
        assert_eq!(pool.index([1, 1]).values(), [0], "never taken from another type");
    }
}
