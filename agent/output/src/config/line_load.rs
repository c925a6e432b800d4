//! Load of serial lines: a rate that a line cannot carry is refused.

use super::destination::SerialOutputConfig;
use super::sentence::SentenceKind;
use super::{ConfigProblem, OutputConfig};

/// Bits of a byte on the line: a start bit, eight data bits and a stop bit.
const BITS_PER_BYTE: f64 = 10.0;
/// Interval of the alerts' sentences: repeated lists, and an assumed mean of changes.
const ALERT_INTERVAL_S: f64 = 30.0;

/// Share of its interval after which a sentence is due again, so that a compass that is a little
/// faster is followed.
pub(crate) const SHORTEST_INTERVAL_SHARE: f64 = 0.98;

impl SentenceKind {
    /// Returns the longest sentence with its line end, and for alerts all that may be sent in
    /// [`ALERT_INTERVAL_S`].
    pub(crate) fn max_bytes(self) -> u32 {
        match self {
            SentenceKind::Hdg => 33,
            SentenceKind::Ths | SentenceKind::Hdt => 19,
            SentenceKind::Pbinq => 40,
            SentenceKind::Alr => 82,
            // A list and a heartbeat, and both sentences of the three alerts.
            SentenceKind::Alf => 82 + 24 + 6 * 82,
        }
    }
}

impl OutputConfig {
    /// Refuses serial lines that cannot carry their sentences.
    pub(super) fn check_lines(&self) -> Result<(), ConfigProblem> {
        self.serial
            .iter()
            .try_for_each(|line| self.check_line(line))
    }

    fn check_line(&self, line: &SerialOutputConfig) -> Result<(), ConfigProblem> {
        let carried = f64::from(line.baud()) / BITS_PER_BYTE;
        let sent = SentenceKind::ALL.into_iter();
        let sent = sent.filter(|kind| self.is_sent(*kind) && line.sentences.includes(*kind));
        let sent: Vec<SentenceKind> = sent.collect();
        let needed: f64 = sent.iter().map(|kind| self.bytes_per_s(*kind)).sum();
        if needed <= carried {
            return Ok(());
        }
        let names: Vec<&str> = sent.iter().map(|kind| kind.name()).collect();
        let span = match &line.baud {
            Some(baud) => baud.span(),
            None => line.path.span(),
        };
        Err(ConfigProblem {
            span,
            problem: format!(
                "{} baud carry {carried:.0} bytes a second, but {} need {:.0}: set a higher baud, \
                 a longer interval_s, or fewer sentences",
                line.baud(),
                names.join(", "),
                needed.ceil()
            ),
        })
    }

    fn bytes_per_s(&self, kind: SentenceKind) -> f64 {
        let interval_s = match kind {
            SentenceKind::Hdg => self.interval_s(self.hdg),
            SentenceKind::Ths => self.interval_s(self.ths),
            SentenceKind::Hdt => self.interval_s(self.hdt),
            SentenceKind::Pbinq => self.interval_s.seconds(),
            SentenceKind::Alr | SentenceKind::Alf => ALERT_INTERVAL_S,
        };
        f64::from(kind.max_bytes()) / (interval_s * SHORTEST_INTERVAL_SHARE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the text that is refused, and why.
    fn refused(text: &str) -> Option<(&str, String)> {
        let config: OutputConfig = toml::from_str(text).unwrap();
        let refused = config.check().err()?;
        Some((&text[refused.span], refused.problem))
    }

    #[test]
    fn a_line_carries_what_its_baud_rate_allows_and_no_more() {
        let is_carried = |baud: u32, output: &str| {
            let line = format!("serial = {{ path = \"/dev/a\", baud = {baud} }}\n{output}");
            refused(&line).is_none()
        };
        assert!(is_carried(4800, ""));
        assert!(!is_carried(300, ""));
        let ths = "hdg = false\nths = { interval_s = 0.1 }\n";
        assert!(is_carried(4800, ths));
        let both = format!("{ths}hdt = {{ interval_s = 0.1 }}\n");
        assert!(is_carried(4800, &both));
        let all = "interval_s = 0.1\nhdt = true\n";
        assert!(!is_carried(4800, all));
        assert!(is_carried(38_400, all));
        let alerts = "alert_sentences = true\nalarm_sentence = true\n";
        assert!(is_carried(1200, "") && !is_carried(1200, &format!("{alerts}hdt = true\n")));
    }

    #[test]
    fn a_rate_too_high_is_refused_at_the_baud_rate_of_its_line() {
        let output = "interval_s = 0.1\nserial = [\n    { path = \"/dev/a\", baud = 38400 },\n    \
                      { path = \"/dev/b\", baud = 4800 },\n]";
        let (value, problem) = refused(output).unwrap();
        assert_eq!(value, "4800");
        assert_eq!(
            problem,
            "4800 baud carry 480 bytes a second, but HDG, THS, PBINQ need 939: set a higher baud, \
             a longer interval_s, or fewer sentences"
        );
        let standard = "interval_s = 0.1\nserial = { path = \"/dev/a\" }";
        assert_eq!(refused(standard).unwrap().0, "\"/dev/a\"");
    }

    #[test]
    fn only_the_sentences_on_the_line_count() {
        let line = |sentences: &str| {
            format!(
                "interval_s = 0.1\nhdt = true\nserial = {{ path = \"/dev/a\", sentences = {sentences} }}"
            )
        };
        assert_eq!(refused(&line("[\"HDT\"]")), None);
        let both = line("[\"HDT\", \"HDG\"]");
        let (_, problem) = refused(&both).unwrap();
        assert!(problem.contains("HDG, HDT need 531"), "{problem}");
    }
}
