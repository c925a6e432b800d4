//! Correctors and compass as the adjuster found them, before anything was moved.

use binnacle_adjustment::binnacle::Setting;
use binnacle_platform::ids::PhotoId;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Correctors and compass as found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = AsFound)]
pub(crate) struct AsFound {
    /// Setting of every corrector as it stands: place, red end, pieces. One that is not named
    /// is not fitted.
    pub setting: Setting,
    /// Checks of the compass alongside.
    pub dockside: DocksideChecks,
    /// Reason for a setting other than recorded; required where they differ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(required = false)]
    pub difference: Option<Difference>,
    /// Photographs of the order that show the correctors.
    #[serde(default)]
    pub photos: Vec<PhotoId>,
}

/// Reason for a setting other than recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = AsFoundDifference)]
pub(crate) enum Difference {
    /// The record was wrong: the correctors stood so while the model's headings were sailed.
    RecordWrong,
    /// Correctors were moved since the model's headings, so that the model no longer holds.
    MovedSince,
}

/// Checks of the compass alongside (NGA, Handbook of Magnetic Compass Adjustment, art. 101).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = DocksideChecks, example = json!({
    "bubble": "sound", "pivot": "sound", "gimbals": "sound", "lubber_line": "sound",
    "spheres_turned_deg": 0.5
}))]
pub(crate) struct DocksideChecks {
    /// No bubble in the bowl.
    pub bubble: DocksideResult,
    /// Pivot and card: deflected by a magnet, the card returns to where it was.
    pub pivot: DocksideResult,
    /// Gimbals: the bowl swings freely and hangs level.
    pub gimbals: DocksideResult,
    /// Lubber line: in the fore-and-aft plane.
    pub lubber_line: DocksideResult,
    /// Largest change of the compass while each Kelvin sphere is turned in its place, degrees:
    /// their residual magnetism. `null` without spheres.
    #[schema(required, minimum = 0, maximum = 180)]
    pub spheres_turned_deg: Option<f64>,
}

/// Result of a check alongside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = DocksideResult)]
pub(crate) enum DocksideResult {
    /// Sound, or mended before the report.
    Sound,
    /// Defective.
    Defective,
}

/// Change of the compass from which spheres are annealed or replaced, degrees.
const MAGNETISED_DEG: f64 = 2.0;

impl DocksideChecks {
    /// Lists what must be mended before anything is planned.
    pub(crate) fn defects(&self) -> Vec<String> {
        let checks = [
            (self.bubble, "there is a bubble in the bowl"),
            (self.pivot, "the card does not return: the pivot is worn"),
            (self.gimbals, "the gimbals do not let the bowl hang level"),
            (
                self.lubber_line,
                "the lubber line is out of the fore-and-aft plane",
            ),
        ];
        let defective = checks
            .iter()
            .filter(|(result, _)| *result == DocksideResult::Defective);
        let mut defects: Vec<String> = defective.map(|(_, what)| (*what).to_owned()).collect();
        let turned_deg = self.spheres_turned_deg.filter(|deg| *deg >= MAGNETISED_DEG);
        defects.extend(turned_deg.map(|deg| {
            format!(
                "the compass turned {deg:.1} degrees while a sphere was turned: the spheres are \
                    magnetised and have to be annealed or replaced"
            )
        }));
        defects
    }
}

/// Lists the differences between the recorded and the found setting, in words.
pub(crate) fn differences(recorded: &Setting, found: &Setting) -> Vec<String> {
    let [was, is] =
        [recorded, found].map(|setting| binnacle_fleet::binnacles::describe_setting(setting, None));
    let pairs = was.iter().zip(&is).filter(|(was, is)| was != is);
    pairs
        .map(|((what, was), (_, is))| format!("{what}: recorded {was}; found {is}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_adjustment::binnacle::{Red, Tray};

    fn sound() -> DocksideChecks {
        DocksideChecks {
            bubble: DocksideResult::Sound,
            pivot: DocksideResult::Sound,
            gimbals: DocksideResult::Sound,
            lubber_line: DocksideResult::Sound,
            spheres_turned_deg: Some(1.0),
        }
    }

    #[test]
    fn each_defect_is_named_and_a_sound_compass_has_none() {
        assert!(sound().defects().is_empty());
        let worn = DocksideChecks {
            pivot: DocksideResult::Defective,
            spheres_turned_deg: Some(3.0),
            ..sound()
        };
        let defects = worn.defects();
        assert_eq!(defects.len(), 2);
        assert!(defects[0].contains("pivot") && defects[1].contains("annealed"));
    }

    #[test]
    fn a_reversed_end_is_a_difference_in_words() {
        let with = |red| Setting {
            fore_and_aft: vec![Tray {
                hole: 5,
                magnet: "200 mm".to_owned(),
                count: 2,
                red,
            }],
            ..Setting::default()
        };
        let found = differences(&with(Red::Aft), &with(Red::Forward));
        assert_eq!(
            found,
            [
                "Fore-and-aft: recorded 2 × 200 mm in hole 5, red aft; found 2 × 200 mm in hole 5, \
              red forward"
            ]
        );
        assert!(differences(&with(Red::Aft), &with(Red::Aft)).is_empty());
    }
}
