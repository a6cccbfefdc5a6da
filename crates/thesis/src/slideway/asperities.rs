//! A range of ridges that fall off from its middle, pressed onto another one: area, load and number of contacts, and the power
//! laws that they come near to.

use super::crossing::Crossing;
use super::power_law::PowerLaw;
use super::root::halved;
use super::units::{KGF, UM, UM2};
use super::{Range, SlidewayError};

const STEP: Range = Range::new("step between contacts", "m", 1e-12, 1e-3);
const OVERLAP: Range = Range::new("overlap of two ranges in steps", "", f64::MIN_POSITIVE, LEVELS.high);
const LOAD: Range = Range::positive("load of a range", "N");
const LEVELS: Range = Range::new("levels", "", 1.0, 1000.0);

/// Two ranges of ridges, crossed. Pairs of ridges touch level by level: one in the middle, then four, eight, ..., each level by one
/// step less than the one before (eq 32-7, Fig 7.6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AsperityRange {
    /// A pair of its ridges.
    pub crossing: Crossing,
    /// Overlap that a level lies below the one before, in m.
    pub step: f64,
}

/// Two ranges pressed onto each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressed {
    /// Overlap of the ranges hd, in m.
    pub overlap: f64,
    /// Real area of contact Ac, in m2.
    pub area: f64,
    /// Load WT, in N.
    pub load: f64,
    /// Number of contacts Nc.
    pub contacts: f64,
}

impl AsperityRange {
    /// The study's range: ridges fall by hT = 0.03 um from one to the next, and its sums step by 2 hT = 0.06 um. (The gap of pair
    /// (i, j) is (|i| + |j|) hT, so that a step of hT would follow from the geometry; the study's figures need 2 hT.)
    ///
    /// # Errors
    /// None: all of it is within the ranges.
    pub fn of_study() -> Result<Self, SlidewayError> {
        Ok(AsperityRange { crossing: Crossing::of_study()?, step: 2.0 * 0.03 * UM })
    }

    /// What an overlap in m comes to (eq 32-7 ... 36-7). Every contact is elastic up to its own yield overlap and plastic beyond.
    ///
    /// # Errors
    /// Where the step is outside of 1e-12 ... 1e-3 m, or the overlap not above 0 or above a thousand steps.
    pub fn pressed(&self, overlap: f64) -> Result<Pressed, SlidewayError> {
        self.checked(overlap)?;
        Ok(self.sum(0, overlap))
    }

    /// The same at a whole number of levels N, hd = N steps.
    ///
    /// # Errors
    /// Where there are no levels, or more than a thousand.
    pub fn at_level(&self, level: u32) -> Result<Pressed, SlidewayError> {
        LEVELS.check(f64::from(level))?;
        self.pressed(f64::from(level) * STEP.check(self.step)?)
    }

    /// What is pressed when a load in N is put on for the first time.
    ///
    /// # Errors
    /// Where the load is not above 0, or more than a thousand levels carry.
    pub fn under(&self, load: f64) -> Result<Pressed, SlidewayError> {
        let load = LOAD.check(load)?;
        let load_at = |overlap: f64| self.sum(0, overlap).load;
        let deepest = LEVELS.high * STEP.check(self.step)?;
        if load_at(deepest) < load {
            let because = format!("{load} N are more than a thousand levels carry");
            return Err(SlidewayError::NoSolution { sought: "overlap", because });
        }
        Ok(self.sum(0, halved(0.0, deepest, |overlap| load_at(overlap) < load)))
    }

    /// What is pressed when the load comes on again after an overload has flattened all levels below `first` (7.2): contacts of the
    /// first whole level touch together, 4 `first` of them, and `overlap` in m counts from there.
    ///
    /// # Errors
    /// As [`AsperityRange::pressed`], and where `first` is not 1 ... 1000.
    pub fn reloaded(&self, first: u32, overlap: f64) -> Result<Pressed, SlidewayError> {
        self.checked(overlap)?;
        LEVELS.check(f64::from(first))?;
        Ok(self.sum(first, overlap))
    }

    /// That an overlap is above 0 and of no more than a thousand steps.
    fn checked(&self, overlap: f64) -> Result<f64, SlidewayError> {
        OVERLAP.check(overlap / STEP.check(self.step)?)
    }

    fn sum(&self, first: u32, overlap: f64) -> Pressed {
        let mut total = Pressed { overlap, area: 0.0, load: 0.0, contacts: 0.0 };
        for level in first.. {
            let left = overlap - f64::from(level - first) * self.step;
            // What rounding leaves of a level that just touches is no contact.
            if left <= 1e-9 * self.step {
                return total;
            }
            let count = f64::from(if level == 0 { 1 } else { 4 * level });
            let (area, load) = self.crossing.pressed(left);
            total.area += count * area;
            total.load += count * load;
            total.contacts += count;
        }
        total
    }
}

/// Power laws of a range over stretches of levels, as Table T7.1 has them: um, um2, kgf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLaws {
    /// Overlap hd by load WT, um by kgf.
    pub overlap: PowerLaw,
    /// Area Ac by load WT, um2 by kgf.
    pub area: PowerLaw,
    /// Overlap hd by area Ac, um by um2.
    pub overlap_of_area: PowerLaw,
    /// Number of contacts Nc by load WT in kgf.
    pub contacts: PowerLaw,
}

/// Levels, first and last, over which a law is fitted.
pub type Levels = (u32, u32);

impl ContactLaws {
    /// Levels over which the sums give the printed laws, in the order of the fields: N 2 ... 25 (1e-4 ... 8 kgf), 2 ... 8 (to
    /// 0.057 kgf, all elastic), 2 ... 8, and 1 ... 10.
    pub const LEVELS_OF_STUDY: [Levels; 4] = [(2, 25), (2, 8), (2, 8), (1, 10)];

    /// Table T7.1 as printed.
    pub const PRINTED: ContactLaws = ContactLaws {
        overlap: PowerLaw::new(0.92, 0.22),
        area: PowerLaw::new(10460.0, 0.82),
        overlap_of_area: PowerLaw::new(0.075, 0.27),
        contacts: PowerLaw::new(520.0, 0.5),
    };

    /// Laws fitted to the sums of a range, each over its own levels.
    ///
    /// # Errors
    /// Where a stretch has fewer than two levels.
    pub fn fitted(range: &AsperityRange, levels: [Levels; 4]) -> Result<Self, SlidewayError> {
        let law = |levels: Levels, x: fn(&Pressed) -> f64, y: fn(&Pressed) -> f64| {
            let points = (levels.0..=levels.1)
                .map(|level| range.at_level(level).map(|pressed| (x(&pressed), y(&pressed))))
                .collect::<Result<Vec<_>, _>>()?;
            PowerLaw::fit(&points)
        };
        let [overlap, area, overlap_of_area, contacts] = levels;
        Ok(ContactLaws {
            overlap: law(overlap, |p| p.load / KGF, |p| p.overlap / UM)?,
            area: law(area, |p| p.load / KGF, |p| p.area / UM2)?,
            overlap_of_area: law(overlap_of_area, |p| p.area / UM2, |p| p.overlap / UM)?,
            contacts: law(contacts, |p| p.load / KGF, |p| p.contacts)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn range() -> AsperityRange {
        AsperityRange::of_study().unwrap()
    }

    #[test]
    fn contacts_come_level_by_level() {
        for (level, contacts) in [(1, 1.0), (2, 5.0), (3, 13.0), (4, 25.0), (7, 85.0), (8, 113.0)] {
            assert_eq!(range().at_level(level).unwrap().contacts, contacts);
        }
    }

    #[test]
    fn table_t7_1_comes_out_of_the_sums() {
        let laws = ContactLaws::fitted(&range(), ContactLaws::LEVELS_OF_STUDY).unwrap();
        let printed = ContactLaws::PRINTED;
        let near = |got: PowerLaw, printed: PowerLaw, share: f64, exponent: f64| {
            assert!((got.factor / printed.factor - 1.0).abs() < share, "{got:?} is not {printed:?}");
            assert!((got.exponent - printed.exponent).abs() < exponent, "{got:?} is not {printed:?}");
        };
        near(laws.overlap, printed.overlap, 0.003, 0.002);
        near(laws.area, printed.area, 0.01, 0.007);
        near(laws.overlap_of_area, printed.overlap_of_area, 0.021, 0.004);
        near(laws.contacts, printed.contacts, 0.002, 0.014);
    }

    #[test]
    fn sums_between_levels_are_those_worked_out_elsewhere() {
        let pressed = range().under(0.65 * KGF).unwrap();
        assert!((pressed.overlap / UM - 0.8175).abs() < 1e-4);
        assert!((pressed.area / UM2 - 8360.0).abs() < 3.0);
        assert!((range().under(KGF).unwrap().overlap / UM - 0.9046).abs() < 1e-4);
    }

    #[test]
    fn a_range_reloaded_begins_with_a_whole_level() {
        let reloaded = range().reloaded(7, 0.12 * UM).unwrap();
        assert_eq!(reloaded.contacts, 60.0);
        assert!((reloaded.load / KGF - 0.00211).abs() < 1e-5);
        assert!((range().reloaded(7, 0.06 * UM).unwrap().area / UM2 - 20.16).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_pressed_is_told() {
        assert!(AsperityRange { step: 0.0, ..range() }.pressed(1e-7).is_err());
        assert!(range().pressed(1e-3).is_err() && range().reloaded(0, 1e-7).is_err());
        assert!(
            range().pressed(0.0).is_err() && range().under(-1.0).is_err() && range().at_level(0).is_err()
        );
        let told = range().under(1e9).unwrap_err().to_string();
        assert_eq!(told, "there is no overlap: 1000000000 N are more than a thousand levels carry");
    }

    proptest! {
        #[test]
        fn a_load_is_carried_by_what_it_presses(kilograms in 1e-4..8.0f64) {
            let pressed = range().under(kilograms * KGF).unwrap();
            prop_assert!((pressed.load / KGF / kilograms - 1.0).abs() < 1e-9);
        }

        #[test]
        fn no_contact_carries_more_than_yielding(kilograms in 1e-4..8.0f64) {
            let pressed = range().under(kilograms * KGF).unwrap();
            let mean = pressed.load / pressed.area / super::super::units::KGF_PER_MM2;
            prop_assert!(mean <= 88.0 * (1.0 + 1e-12));
        }
    }
}
