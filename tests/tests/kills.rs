//! Sweeps ended by SIGKILL at random moments and resumed until they are complete: no finished point is computed twice, and the map
//! is, byte for byte, that of a run that nobody disturbed.
//!
//! Eight kills of a FREE's sweep and a quarter as many of a module's; `tests/kills/run 1000` for more (`FREEACT_KILLS`,
//! `FREEACT_KILLS_OF_MODULES`, and `FREEACT_KILLS_SEED` for other moments). What lies on disk is read as `docs/formats.md` describes it, and by the library.
#![cfg(target_os = "linux")]

use actuator::{PointStore, artefact};
use freeact_tests::{data, program};
use std::{
    env,
    fs::{self, File},
    io::{Read, Seek},
    os::unix::process::ExitStatusExt,
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    thread::sleep,
    time::{Duration, Instant, SystemTime},
};

const SIGKILL: i32 = 9;

const JOBS: [&str; 2] = ["1", "2"];

/// Random numbers: splitmix64, the same on every machine.
struct Random(u64);

impl Random {
    fn fraction(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.fraction() * count as f64) as usize).min(count - 1)
    }
}

/// A sweep of about a second, and what it gives undisturbed.
struct Sweep {
    name: &'static str,
    /// Paths, or rows and checks.
    points: usize,
    arguments: Vec<String>,
    /// First and last time of a kill, in parts of the time that the sweep takes.
    kills: [f64; 2],
    map: Vec<u8>,
    /// Time that the last undisturbed run took, s: it varies with what else the machine does.
    seconds: f64,
    /// Processor time of each undisturbed run, s: it varies as well.
    cpu: Vec<f64>,
}

impl Sweep {
    fn new((name, points): (&'static str, usize), kills: [f64; 2], of: &str, settings: &str) -> Self {
        let of = data(of).display().to_string();
        let mut arguments = vec!["--of".to_owned(), of];
        arguments.extend(settings.split_whitespace().map(str::to_owned));
        let mut sweep = Sweep { name, points, arguments, kills, map: vec![], seconds: 0.0, cpu: vec![] };
        sweep.map = sweep.run_undisturbed("1");
        sweep
    }

    fn run_undisturbed(&mut self, jobs: &str) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let (before, start) = (cpu_of_children(), Instant::now());
        let (mut run, _) = self.start(folder.path(), &["--jobs", jobs]);
        let status = run.wait().unwrap();
        assert!(status.success(), "{}: {status}: {}", self.name, said(&mut run));
        self.cpu.push(cpu_of_children() - before);
        self.seconds = start.elapsed().as_secs_f64();
        assert_eq!(files(folder.path()).len(), 1, "more than the map is left");
        fs::read(map_in(folder.path())).unwrap()
    }

    fn undisturbed_cpu(&self) -> f64 {
        self.cpu.iter().sum::<f64>() / self.cpu.len() as f64
    }

    /// A run, and the file that its standard output goes to: a pipe would fill up, with nobody reading.
    fn start(&self, folder: &Path, more: &[&str]) -> (Child, File) {
        let told = tempfile::tempfile().unwrap();
        let mut command = Command::new(program());
        command.arg("map").args(&self.arguments).arg("--out").arg(map_in(folder)).args(more);
        command.arg("--json").stdout(told.try_clone().unwrap()).stderr(Stdio::piped());
        (command.spawn().unwrap(), told)
    }
}

/// Processor time (s) of the programs that this one has started and waited for.
fn cpu_of_children() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    // Fields 16 and 17, cutime and cstime, in ticks of 10 ms; the name in field 2 may hold spaces.
    let fields = stat.rsplit_once(')').unwrap().1.split_whitespace();
    fields.skip(13).take(2).map(|ticks| ticks.parse::<f64>().unwrap()).sum::<f64>() / 100.0
}

/// What a run wrote to its standard error.
fn said(run: &mut Child) -> String {
    let mut text = String::new();
    run.stderr.take().unwrap().read_to_string(&mut text).unwrap();
    text
}

fn map_in(folder: &Path) -> PathBuf {
    folder.join("sweep.map")
}

fn points_in(folder: &Path) -> PathBuf {
    folder.join("sweep.map.points")
}

/// Where the records of a log end, the last one perhaps cut off; and whether it is.
fn records(log: &Path) -> (Vec<usize>, bool) {
    let bytes = fs::read(log).unwrap();
    let mut ends = vec![12];
    loop {
        let at = *ends.last().unwrap();
        let Some(length) = bytes.get(at..at + 4) else { return (ends, at < bytes.len()) };
        let end = at + 4 + 32 + 4 + u32::from_le_bytes(length.try_into().unwrap()) as usize + 32;
        if end > bytes.len() {
            return (ends, true);
        }
        ends.push(end);
    }
}

/// Number of whole records in all logs, and of logs that end in half a one.
fn whole_records(folder: &Path) -> (usize, usize) {
    let logs = files(&points_in(folder)).into_iter().map(|(log, ..)| records(&log));
    logs.fold((0, 0), |(whole, torn), (ends, is_torn)| (whole + ends.len() - 1, torn + usize::from(is_torn)))
}

/// Files of a folder and those below it, with length and time of change; what vanishes meanwhile is left out.
fn files(folder: &Path) -> Vec<(PathBuf, u64, SystemTime)> {
    let mut found = vec![];
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        match entry.metadata() {
            Ok(data) if data.is_dir() => found.extend(files(&entry.path())),
            Ok(data) => found.push((entry.path(), data.len(), data.modified().unwrap())),
            Err(_) => {}
        }
    }
    found.sort();
    found
}

/// Whether a map file is whole: its checksum is that of its content.
fn is_whole(map: &Path) -> bool {
    artefact::read::<()>(map, artefact::MAP).is_ok()
}

/// Lets a run go on for `delay`, and from then on until something changes in its folder where the end of a write is wanted; then
/// ends it. Gives how it ended, which may have been on its own.
fn kill(run: &mut Child, folder: &Path, delay: Duration, writing: bool) -> ExitStatus {
    let end = Instant::now() + delay;
    while Instant::now() < end {
        if let Some(status) = run.try_wait().unwrap() {
            return status;
        }
        sleep(Duration::from_millis(1).min(end.saturating_duration_since(Instant::now())));
    }
    let before = files(folder);
    while writing && files(folder) == before {
        if let Some(status) = run.try_wait().unwrap() {
            return status;
        }
    }
    run.kill().unwrap();
    run.wait().unwrap()
}

/// What the kills of one sweep came to.
#[derive(Default)]
struct Tally {
    kills: usize,
    maps: usize,
    /// Kills that left half a record, and records that were cut off afterwards, as by a loss of power.
    torn: usize,
    cut: usize,
    /// Points found finished when a map was completed.
    found: usize,
    /// Processor time of all runs, s.
    cpu: f64,
}

#[test]
fn a_map_is_the_same_whenever_its_sweep_was_killed() {
    let variable = |name: &str, usual| env::var(name).map_or(usual, |text| text.parse().unwrap());
    let (wanted, seed) = (variable("FREEACT_KILLS", 8), variable("FREEACT_KILLS_SEED", 1));
    let of_modules = variable("FREEACT_KILLS_OF_MODULES", wanted / 4);
    let mut random = Random(seed as u64);
    let sweeps = [
        Sweep::new(
            ("12 paths of a FREE", 12),
            [0.0, 0.6],
            "actuators/buffinton-2020.toml",
            "--winding-angles 20:60:10 --shear-moduli-mpa 0.2,0.4 --checks 2 --pressure-step-kpa 20 --interpolation-tolerance 1",
        ),
        Sweep::new(
            ("30 rows and 10 checks of a module", 40),
            // Its first seconds make the laws of its rods, and finish nothing.
            [0.4, 1.0],
            "modules/buffinton-2020-30lr.toml",
            "--nodes 4 --checks 10 --pressure-max-kpa 20",
        ),
    ];
    println!(
        "sweep: kills, half records left, records cut off; maps, points found; processor time a map, undisturbed, more a kill"
    );
    for (mut sweep, wanted) in sweeps.into_iter().zip([wanted, of_modules]).filter(|(_, wanted)| *wanted > 0)
    {
        let (start, mut tally) = (Instant::now(), Tally::default());
        while tally.kills < wanted {
            if tally.maps % 8 == 7 {
                sweep.run_undisturbed(JOBS[random.below(2)]);
            }
            kill_until_complete(&sweep, wanted, &mut random, &mut tally);
        }
        let Tally { kills, maps, torn, cut, found, cpu } = tally;
        println!(
            "{}: {kills}, {torn}, {cut}; {maps}, {found}; {:.2} s, {:.2} s, {:.3} s; took {:.0} s, seed {seed}",
            sweep.name,
            cpu / maps as f64,
            sweep.undisturbed_cpu(),
            (cpu - maps as f64 * sweep.undisturbed_cpu()) / kills as f64,
            start.elapsed().as_secs_f64()
        );
    }
}

/// Kills one sweep until there are as many kills as wanted, or it completes in spite of them.
fn kill_until_complete(sweep: &Sweep, wanted: usize, random: &mut Random, tally: &mut Tally) {
    let folder = tempfile::tempdir().unwrap();
    let (folder, map) = (folder.path(), map_in(folder.path()));
    let cpu_before = cpu_of_children();
    let (mut finished, mut torn_before) = (0, 0);
    loop {
        let at = format!("{}, kill {}, map {}", sweep.name, tally.kills, tally.maps);
        let mut more = vec!["--jobs", JOBS[random.below(2)]];
        if points_in(folder).exists() || map.exists() {
            more.push("--resume");
        }
        let (mut run, mut told) = sweep.start(folder, &more);
        let status = match tally.kills < wanted {
            true => {
                let [first, last] = sweep.kills;
                let delay =
                    Duration::from_secs_f64((first + (last - first) * random.fraction()) * sweep.seconds);
                kill(&mut run, folder, delay, random.below(2) == 0)
            }
            false => run.wait().unwrap(),
        };
        if status.success() {
            told.rewind().unwrap();
            let told: serde_json::Value = serde_json::from_reader(told).unwrap();
            let count = |name: &str| told[name].as_u64().unwrap() as usize;
            // Nothing that was finished was computed again; all of it, if the kill before came when the map was there.
            assert!(
                count("points_found") == finished || count("points_computed") == 0,
                "{at}: {finished}, {told}"
            );
            assert_eq!(count("points_found") + count("points_computed"), sweep.points, "{at}");
            tally.found += count("points_found");
            assert!(fs::read(&map).unwrap() == sweep.map, "{at}: another map");
            assert_eq!(files(folder).len(), 1, "{at}: more than the map is left");
            break;
        }
        assert_eq!(status.signal(), Some(SIGKILL), "{at}: {status}: {}", said(&mut run));
        tally.kills += 1;
        assert!(!map.exists() || is_whole(&map), "{at}: half a map");
        if !points_in(folder).exists() {
            continue;
        }
        let (whole, torn) = whole_records(folder);
        // Once the map is there, the logs go.
        assert!(whole >= finished || map.exists(), "{at}: {finished} points, then {whole}");
        tally.torn += torn.saturating_sub(torn_before);
        finished = whole;
        if random.below(4) == 0 && !map.exists() {
            let cut = cut_off(folder, random);
            (tally.cut, finished) = (tally.cut + cut, finished - cut);
        }
        torn_before = whole_records(folder).1;
        let store = PointStore::open(&points_in(folder)).unwrap();
        assert_eq!((store.len(), store.warnings()), (finished, &[][..]), "{at}");
    }
    tally.maps += 1;
    tally.cpu += cpu_of_children() - cpu_before;
}

/// Cuts off the last record of the last log somewhere, as a loss of power may. Gives the number of records lost, one or none.
fn cut_off(folder: &Path, random: &mut Random) -> usize {
    let Some((log, ..)) = files(&points_in(folder)).pop() else { return 0 };
    let (ends, is_torn) = records(&log);
    let [.., before, last] = ends[..] else { return 0 };
    if is_torn {
        return 0;
    }
    let length = before + random.below(last - before);
    fs::OpenOptions::new().write(true).open(&log).unwrap().set_len(length as u64).unwrap();
    1
}
