//! The diagnostic codes of experiments. Those of patches are constants of
//! [`Code`](patchcord_core::document::Code).

use patchcord_core::diagnostic_codes;

diagnostic_codes! {
    /// All codes of experiments, in the order of the reference page.
    self::ALL;
    BAD_PATCH "bad-patch" Error "The patch of an experiment cannot be read or has errors."
        "`patchcord check` lists the errors of a patch";
    BAD_DATA "bad-data" Error "A file of measured data cannot be read or does not contain the required data."
        "data are a CSV file: a line of names, and a line of numbers for every sample";
    UNEVEN_SAMPLING "uneven-sampling" Error "The samples are not evenly spaced."
        "interpolate the data to even times; whole rows may be missing";
    TOO_FEW_SAMPLES "too-few-samples" Error "There are too few samples for training or validation."
        "record for a longer time or at a higher rate, or widen the range";
    CONSTANT_COLUMN "constant-column" Error "A column is constant and so contains no information."
        "check the name of the column";
    NOT_FITTABLE "not-fittable" Error "A parameter cannot be fitted."
        "fit another parameter, or give this one a range";
    OFF_SCALE "off-scale" Error "More than 1 % of the samples exceed 100 V in their scale, or a sample exceeds 100 kV: \
        the machine would cut them off."
        "increase per_volt of the scale, correct the \"unit\" of the column, or remove rows with recording errors";
    DRIVE_RESTARTS "drive-begins-anew" Error "A drive without a column starts at time 0, but its record starts later."
        "feed the drive from a column; or use training and validation records that start with the drive; or let its \
        formulas use a parameter record_start in s, which is set to the start of the record";
    SAMPLING_GAP "sampling-gap" Warning "Rows are missing between other rows."
        "check whether the recorder lost them; this time is ignored";
    EARLY_LAST_ROW "early-last-row" Warning "The last row follows after less than an interval and is left out."
        "record whole intervals, or remove the row";
    SHARED_SAMPLES "shared-samples" Warning "Samples are used for both training and validation, or are listed twice."
        "separate the two: training samples do not validate the model";
    STILL_PART "still-part" Warning "A column is constant in the samples for training or validation."
        "choose samples in which it changes";
    WILD_SAMPLE "wild-sample" Warning "Samples of a column differ strongly from their neighbours."
        "look at them, and remove rows with recording errors: removed rows count as missing";
    BEYOND_DATA "beyond-data" Warning "A range of samples extends beyond the data."
        "correct the range: only the part with data is used";
    BEYOND_SCALE "beyond-scale" Warning "A few samples exceed 100 V in their scale."
        "increase per_volt of the scale";
    BELOW_SCALE "below-scale" Warning "A column uses less than a thousandth of its scale."
        "correct the \"unit\" of the column, or decrease per_volt of the scale";
    SHARED_COLUMN "shared-column" Warning "Two drives or outputs use the same column."
        "name a different column for each";
    UNFED_DRIVES "unfed-drives" Warning "No column feeds a drive that changes in the patch, or no column feeds \
        any drive and so nothing moves."
        "if the drive was measured, name its column under \"drives\"";
    NOTHING_TO_FIT "nothing-to-fit" Warning "The patch of an experiment has no parameter that can be fitted."
        "give the unknown parameters a range; if all are known, write \"fit\": []";
}
