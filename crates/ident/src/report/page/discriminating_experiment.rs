//! The experiment that would tell two effects apart.

use crate::report::discriminating_experiment::experiment_sentence;
use crate::search::outcome::Outcome;
use patchcord_draw::html::escaped;

pub(super) fn section(outcome: &Outcome) -> String {
    let Some(found) = &outcome.separating else { return String::new() };
    let [one, other] = &found.from;
    format!(
        "<section>\n<h2>What would tell them apart</h2>\n<p>{} or {}: {}. Both patches stand at rest at first; what counts is what is left when \
         one of them is fitted to what the other predicts. <a href=\"separate.csv\">separate.csv</a> has the drive and both predictions.</p>\n</section>\n",
        escaped(one),
        escaped(other),
        escaped(&experiment_sentence(found))
    )
}
