//! Command line of the study.

/// Text for a wrong command line.
pub(crate) const USAGE: &str = "usage: real_ships_study [--ships N] [--seeds SHIFT] \
    [--rows NAME,NAME] [--every DAYS] [--threads N] [--words] [--list]";

pub(crate) struct Arguments {
    /// Ships of each row.
    pub(crate) ships: u64,
    /// Shift of all seeds: what was tuned on some ships is to be judged on others.
    pub(crate) seeds: u64,
    /// Names of the rows; all if empty.
    pub(crate) rows: Vec<String>,
    /// Days between the looks at a growing voyage.
    pub(crate) every_days: usize,
    pub(crate) threads: usize,
    /// True if every false report is printed before its row.
    pub(crate) words: bool,
    pub(crate) list: bool,
}

impl Arguments {
    pub(crate) fn parse(mut given: impl Iterator<Item = String>) -> Result<Arguments, String> {
        let mut arguments = Arguments {
            ships: 6,
            seeds: 0,
            rows: Vec::new(),
            every_days: 30,
            threads: 1,
            words: false,
            list: false,
        };
        while let Some(word) = given.next() {
            let mut number = || number(&word, given.next());
            match word.as_str() {
                "--ships" => arguments.ships = number()?,
                "--seeds" => arguments.seeds = number()?,
                "--every" => arguments.every_days = number()?.max(1) as usize,
                "--threads" => arguments.threads = number()?.max(1) as usize,
                "--words" => arguments.words = true,
                "--list" => arguments.list = true,
                "--rows" => {
                    let names = given.next().ok_or("--rows: names are missing")?;
                    arguments.rows = names.split(',').map(str::to_owned).collect();
                }
                _ => return Err(format!("{word} is no option")),
            }
        }
        Ok(arguments)
    }

    pub(crate) fn has(&self, row: &str) -> bool {
        self.rows.is_empty() || self.rows.iter().any(|name| name == row)
    }

    /// Returns a wanted row that does not exist.
    pub(crate) fn unknown(&self, names: &[&str]) -> Option<&String> {
        let mut wanted = self.rows.iter();
        wanted.find(|wanted| !names.contains(&wanted.as_str()))
    }

    /// Runs a piece of work for every ship, with the results in the order of the seeds.
    pub(crate) fn each<T: Send>(&self, first: u64, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
        let first = first + self.seeds;
        let seeds: Vec<u64> = (first..first + self.ships).collect();
        let (threads, work) = (self.threads, &work);
        let mut results: Vec<(u64, T)> = std::thread::scope(|scope| {
            let started: Vec<_> = (0..threads)
                .map(|t| {
                    let own: Vec<u64> = seeds.iter().copied().skip(t).step_by(threads).collect();
                    scope.spawn(move || own.into_iter().map(|s| (s, work(s))).collect::<Vec<_>>())
                })
                .collect();
            let joined = started
                .into_iter()
                .flat_map(|thread| thread.join().unwrap());
            joined.collect()
        });
        results.sort_by_key(|(seed, _)| *seed);
        results.into_iter().map(|(_, result)| result).collect()
    }
}

fn number(option: &str, given: Option<String>) -> Result<u64, String> {
    let given = given.ok_or_else(|| format!("{option}: a number is missing"))?;
    given
        .parse()
        .map_err(|_| format!("{option}: {given} is not a whole number"))
}
