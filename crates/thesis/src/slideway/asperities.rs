//! Two ranges of ridges pressed onto each other: area, load and number of contacts.
//!
//! The ridges of a range fall from its middle to its edges, so pairs of ridges touch level by level. The module sums
//! the contacts of all levels and fits the power laws of Table T7.1 to these sums.

use super::crossing::Crossing;
use super::power_law::PowerLaw;
use super::root::bisect;
use super::units::{KGF, UM, UM2};
use super::{Range, SlidewayError};

const STEP: Range = Range::new("step between contacts", "m", 1e-12, 1e-3);
const OVERLAP: Range = Range::new("overlap of two ranges in steps", "", f64::MIN_POSITIVE, LEVELS.high);
const LOAD: Range = Range::positive("load of a range", "N");
const LEVELS: Range = Range::new("levels", "", 1.0, 1000.0);

/// Two crossed ranges of ridges (eq 32-7, Fig 7.6).
///
/// Pairs of ridges touch level by level: one pair in the middle, then four, eight and so on. The overlap of each
/// level is one step less than that of the level before.
///
/// # Examples
///
/// Three levels of contacts, with the area of eq 34-7:
///
/// ```
/// use patchcord_thesis::slideway::asperities::AsperityRange;
/// use patchcord_thesis::slideway::units::UM2;
///
/// let pressed = AsperityRange::of_thesis()?.at_level(3)?;
/// assert_eq!(pressed.contacts, 1.0 + 4.0 + 8.0);
/// assert!((pressed.area / UM2 - 23.76).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AsperityRange {
    /// A pair of its ridges.
    pub crossing: Crossing,
    /// Difference of overlap between a level and the level before, in m.
    pub step: f64,
}

/// The state of two ranges that are pressed onto each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeContact {
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
    /// The thesis's range: ridges fall by hT = 0.03 um from one to the next, and its sums use steps of 2 hT = 0.06 um.
    ///
    /// The gap of pair (i, j) is (|i| + |j|) hT, so the geometry gives a step of hT. The thesis's figures need 2 hT.
    ///
    /// # Errors
    /// None: all values are within the ranges.
    pub fn of_thesis() -> Result<Self, SlidewayError> {
        Ok(AsperityRange { crossing: Crossing::of_thesis()?, step: 2.0 * 0.03 * UM })
    }

    /// Area, load and contacts at an overlap in m (eq 32-7 ... 36-7). Every contact is elastic up to its own yield
    /// overlap and plastic above it.
    ///
    /// # Errors
    /// If the step is outside 1e-12 ... 1e-3 m, or the overlap not above 0 or above a thousand steps.
    pub fn pressed(&self, overlap: f64) -> Result<RangeContact, SlidewayError> {
        self.checked(overlap)?;
        Ok(self.sum(0, overlap))
    }

    /// Area, load and contacts at a whole number of levels N, at the overlap hd = N steps.
    ///
    /// # Errors
    /// If the number of levels is outside 1 ... 1000.
    pub fn at_level(&self, level: u32) -> Result<RangeContact, SlidewayError> {
        LEVELS.check(f64::from(level))?;
        self.pressed(f64::from(level) * STEP.check(self.step)?)
    }

    /// Overlap, area and contacts when a load in N is applied for the first time.
    ///
    /// # Errors
    /// If the load is not above 0, or larger than a thousand levels carry.
    pub fn under(&self, load: f64) -> Result<RangeContact, SlidewayError> {
        let load = LOAD.check(load)?;
        let load_at = |overlap: f64| self.sum(0, overlap).load;
        let deepest = LEVELS.high * STEP.check(self.step)?;
        if load_at(deepest) < load {
            let reason = format!("{load} N exceed the load that a thousand levels carry");
            return Err(SlidewayError::NoSolution { sought: "overlap", reason });
        }
        Ok(self.sum(0, bisect(0.0, deepest, |overlap| load_at(overlap) < load)))
    }

    /// Area, load and contacts when the load is applied again after an overload has flattened all levels below
    /// `first` (7.2).
    ///
    /// The 4 `first` contacts of the first whole level touch at the same time. `overlap` in m is measured from there.
    ///
    /// # Errors
    /// As [`AsperityRange::pressed`], and where `first` is not 1 ... 1000.
    pub fn reloaded(&self, first: u32, overlap: f64) -> Result<RangeContact, SlidewayError> {
        self.checked(overlap)?;
        LEVELS.check(f64::from(first))?;
        Ok(self.sum(first, overlap))
    }

    /// The overlap in steps, if it is above 0 and at most a thousand steps.
    fn checked(&self, overlap: f64) -> Result<f64, SlidewayError> {
        OVERLAP.check(overlap / STEP.check(self.step)?)
    }

    /// The sum over all levels from `first` on.
    fn sum(&self, first: u32, overlap: f64) -> RangeContact {
        let mut total = RangeContact { overlap, area: 0.0, load: 0.0, contacts: 0.0 };
        for level in first.. {
            let level_overlap = overlap - f64::from(level - first) * self.step;
            // A level that just touches has no contact; its remainder is rounding.
            if level_overlap <= 1e-9 * self.step {
                return total;
            }
            let count = f64::from(if level == 0 { 1 } else { 4 * level });
            let (area, load) = self.crossing.pressed(level_overlap);
            total.area += count * area;
            total.load += count * load;
            total.contacts += count;
        }
        total
    }
}

/// Power laws of a range over spans of levels, in the units of Table T7.1: um, um2, kgf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLaws {
    /// Overlap hd in um against load WT in kgf.
    pub overlap: PowerLaw,
    /// Area Ac in um2 against load WT in kgf.
    pub area: PowerLaw,
    /// Overlap hd in um against area Ac in um2.
    pub overlap_of_area: PowerLaw,
    /// Number of contacts Nc against load WT in kgf.
    pub contacts: PowerLaw,
}

/// The first and the last level over which a law is fitted.
pub type Levels = (u32, u32);

impl ContactLaws {
    /// The levels over which the sums give the printed laws, in the order of the fields: N 2 ... 25 (1e-4 ... 8 kgf),
    /// 2 ... 8 (up to 0.057 kgf, all elastic), 2 ... 8, and 1 ... 10.
    pub const LEVELS_OF_THESIS: [Levels; 4] = [(2, 25), (2, 8), (2, 8), (1, 10)];

    /// Table T7.1 as printed.
    pub const PRINTED: ContactLaws = ContactLaws {
        overlap: PowerLaw::new(0.92, 0.22),
        area: PowerLaw::new(10460.0, 0.82),
        overlap_of_area: PowerLaw::new(0.075, 0.27),
        contacts: PowerLaw::new(520.0, 0.5),
    };

    /// Laws fitted to the sums of a range, each over its own levels. `levels` is in the order of the fields.
    ///
    /// # Errors
    /// If a span has fewer than two levels.
    pub fn fitted(range: &AsperityRange, levels: [Levels; 4]) -> Result<Self, SlidewayError> {
        let law = |levels: Levels, x: fn(&RangeContact) -> f64, y: fn(&RangeContact) -> f64| {
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
        AsperityRange::of_thesis().unwrap()
    }

    #[test]
    fn contacts_are_counted_level_by_level() {
        for (level, contacts) in [(1, 1.0), (2, 5.0), (3, 13.0), (4, 25.0), (7, 85.0), (8, 113.0)] {
            assert_eq!(range().at_level(level).unwrap().contacts, contacts);
        }
    }

    #[test]
    fn table_t7_1_follows_from_the_sums() {
        let laws = ContactLaws::fitted(&range(), ContactLaws::LEVELS_OF_THESIS).unwrap();
        let printed = ContactLaws::PRINTED;
        let assert_law = |got: PowerLaw, printed: PowerLaw, share: f64, exponent: f64| {
            assert!((got.factor / printed.factor - 1.0).abs() < share, "got {got:?}, printed {printed:?}");
            assert!((got.exponent - printed.exponent).abs() < exponent, "got {got:?}, printed {printed:?}");
        };
        assert_law(laws.overlap, printed.overlap, 0.003, 0.002);
        assert_law(laws.area, printed.area, 0.01, 0.007);
        assert_law(laws.overlap_of_area, printed.overlap_of_area, 0.021, 0.004);
        assert_law(laws.contacts, printed.contacts, 0.002, 0.014);
    }

    #[test]
    fn sums_between_levels_agree_with_an_independent_calculation() {
        let pressed = range().under(0.65 * KGF).unwrap();
        assert!((pressed.overlap / UM - 0.8175).abs() < 1e-4);
        assert!((pressed.area / UM2 - 8360.0).abs() < 3.0);
        assert!((range().under(KGF).unwrap().overlap / UM - 0.9046).abs() < 1e-4);
    }

    #[test]
    fn reloading_begins_with_a_whole_level() {
        let reloaded = range().reloaded(7, 0.12 * UM).unwrap();
        assert_eq!(reloaded.contacts, 60.0);
        assert!((reloaded.load / KGF - 0.00211).abs() < 1e-5);
        assert!((range().reloaded(7, 0.06 * UM).unwrap().area / UM2 - 20.16).abs() < 1e-9);
    }

    #[test]
    fn impossible_overlaps_and_loads_are_refused() {
        assert!(AsperityRange { step: 0.0, ..range() }.pressed(1e-7).is_err());
        assert!(range().pressed(1e-3).is_err() && range().reloaded(0, 1e-7).is_err());
        assert!(
            range().pressed(0.0).is_err() && range().under(-1.0).is_err() && range().at_level(0).is_err()
        );
        let error = range().under(1e9).unwrap_err().to_string();
        assert_eq!(error, "there is no overlap: 1000000000 N exceed the load that a thousand levels carry");
    }

    proptest! {
        #[test]
        fn load_is_carried_by_its_contacts(kilograms in 1e-4..8.0f64) {
            let pressed = range().under(kilograms * KGF).unwrap();
            prop_assert!((pressed.load / KGF / kilograms - 1.0).abs() < 1e-9);
        }

        #[test]
        fn no_contact_exceeds_the_yield_pressure(kilograms in 1e-4..8.0f64) {
            let pressed = range().under(kilograms * KGF).unwrap();
            let mean = pressed.load / pressed.area / super::super::units::KGF_PER_MM2;
            prop_assert!(mean <= 88.0 * (1.0 + 1e-12));
        }
    }
}
