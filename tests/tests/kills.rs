//! Sweeps ended by SIGKILL at random moments and resumed until they are complete: the map is, byte for byte, that of a run that
//! nobody disturbed.
//!
//! Ten kills; `tests/kills/run 1000` for more (`FREEACT_KILLS`, and `FREEACT_KILLS_SEED` for other moments). How the program keeps
//! what is finished is its own affair: the test takes the folder it was told to write to, and looks into map files only.
#![cfg(target_os = "linux")]

use actuator::artefact;
use freeact_tests::{data, program};
use std::{
    env, fs,
    io::Read,
    os::unix::process::ExitStatusExt,
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    thread::sleep,
    time::{Duration, Instant, SystemTime},
};

const SIGKILL: i32 = 9;

/// Seconds between two savings: with zero each finished path is saved, and a kill during a write is likely.
const SAVE_EVERY_S: [&str; 2] = ["0", "0.1"];

const JOBS: [&str; 2] = ["1", "2"];

/// Greatest time until a kill, in parts of the time that the sweep takes: most sweeps are killed several times.
const LATEST_KILL: f64 = 0.6;

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
    arguments: Vec<String>,
    map: Vec<u8>,
    /// Time it takes on one thread, s.
    seconds: f64,
    /// Processor time of each undisturbed run, s: it varies with what else the machine does.
    cpu: Vec<f64>,
}

impl Sweep {
    fn new(name: &'static str, of: &str, settings: &str) -> Self {
        let of = data(of).display().to_string();
        let mut arguments = vec!["--of".to_owned(), of];
        arguments.extend(settings.split_whitespace().map(str::to_owned));
        let mut sweep = Sweep { name, arguments, map: vec![], seconds: 0.0, cpu: vec![] };
        let start = Instant::now();
        sweep.map = sweep.run_undisturbed("1");
        sweep.seconds = start.elapsed().as_secs_f64();
        sweep
    }

    fn run_undisturbed(&mut self, jobs: &str) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let before = cpu_of_children();
        let mut run = self.start(folder.path(), &["--jobs", jobs]);
        let status = run.wait().unwrap();
        assert!(status.success(), "{}: {status}: {}", self.name, said(&mut run));
        self.cpu.push(cpu_of_children() - before);
        fs::read(map_in(folder.path())).unwrap()
    }

    fn undisturbed_cpu(&self) -> f64 {
        self.cpu.iter().sum::<f64>() / self.cpu.len() as f64
    }

    fn start(&self, folder: &Path, more: &[&str]) -> Child {
        let mut command = Command::new(program());
        command.arg("map").args(&self.arguments).arg("--out").arg(map_in(folder)).args(more);
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    }
}

/// Processor time (s) of the programs that this one has started and waited for.
fn cpu_of_children() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    // Fields 16 and 17, cutime and cstime, in ticks of 10 ms; the name in field 2 may hold spaces.
    let fields = stat.rsplit_once(')').unwrap().1.split_whitespace();
    fields.skip(13).take(2).map(|ticks| ticks.parse::<f64>().unwrap()).sum::<f64>() / 100.0
}

fn said(run: &mut Child) -> String {
    let mut text = String::new();
    run.stderr.take().unwrap().read_to_string(&mut text).unwrap();
    text
}

fn map_in(folder: &Path) -> PathBuf {
    folder.join("sweep.map")
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

/// Whether a file is one that was being written, not yet in its place.
fn is_beside(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension == "part")
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

/// What the kills of one sweep at one interval of saving came to.
#[derive(Default)]
struct Tally {
    kills: usize,
    maps: usize,
    /// Kills after which an unfinished file lay beside the map, and was not whole.
    torn: usize,
    /// Processor time of all runs, s.
    cpu: f64,
}

#[test]
fn a_map_is_the_same_whenever_its_sweep_was_killed() {
    let variable = |name: &str, usual| env::var(name).map_or(usual, |text| text.parse().unwrap());
    let (wanted, seed) = (variable("FREEACT_KILLS", 10), variable("FREEACT_KILLS_SEED", 1));
    let mut random = Random(seed as u64);
    let mut sweeps = [
        Sweep::new(
            "36 paths of a FREE",
            "actuators/buffinton-2020.toml",
            "--winding-angles 20:70:10 --shear-moduli-mpa 0.2:0.6:0.1 --pressure-step-kpa 20",
        ),
        Sweep::new(
            "256 states of a module",
            "modules/buffinton-2020-30lr.toml",
            "--nodes 4 --checks 10 --pressure-max-kpa 20",
        ),
    ];
    let start = Instant::now();
    let mut tallies: Vec<Tally> = std::iter::repeat_with(Tally::default).take(4).collect();
    let mut kills = 0;
    for round in 0.. {
        if kills >= wanted {
            break;
        }
        // Three of four rounds are of the FREE, which has more to save.
        let (which, save) = (usize::from(round % 4 == 3), random.below(SAVE_EVERY_S.len()));
        if round % 16 >= 12 {
            sweeps[which].run_undisturbed(JOBS[random.below(2)]);
        }
        let (sweep, tally) = (&sweeps[which], &mut tallies[2 * which + save]);
        let folder = tempfile::tempdir().unwrap();
        let before = cpu_of_children();
        loop {
            let mut more = vec!["--save-every-s", SAVE_EVERY_S[save], "--jobs", JOBS[random.below(2)]];
            if files(folder.path()).iter().any(|(file, ..)| !is_beside(file)) {
                more.push("--resume");
            }
            let mut run = sweep.start(folder.path(), &more);
            let status = match kills < wanted {
                true => {
                    let delay = Duration::from_secs_f64(LATEST_KILL * random.fraction() * sweep.seconds);
                    kill(&mut run, folder.path(), delay, random.below(2) == 0)
                }
                false => run.wait().unwrap(),
            };
            let map = map_in(folder.path());
            if status.success() {
                assert_eq!(files(folder.path()).iter().filter(|(file, ..)| is_beside(file)).count(), 0);
                assert!(fs::read(&map).unwrap() == sweep.map, "seed {seed}, round {round}: another map");
                break;
            }
            assert_eq!(
                status.signal(),
                Some(SIGKILL),
                "seed {seed}, round {round}: {status}: {}",
                said(&mut run)
            );
            assert!(!map.exists() || is_whole(&map), "seed {seed}, round {round}: half a map");
            let left = files(folder.path());
            tally.torn += usize::from(left.iter().any(|(file, ..)| is_beside(file) && !is_whole(file)));
            tally.kills += 1;
            kills += 1;
        }
        tally.maps += 1;
        tally.cpu += cpu_of_children() - before;
    }
    println!("{kills} kills in {:.0} s, every map as without them", start.elapsed().as_secs_f64());
    println!(
        "sweep, savings: kills, torn files left beside, maps; processor time a map, undisturbed, more a kill"
    );
    for (at, Tally { kills, maps, torn, cpu }) in tallies.into_iter().enumerate().filter(|(_, t)| t.maps > 0)
    {
        let (sweep, save) = (&sweeps[at / 2], SAVE_EVERY_S[at % 2]);
        println!(
            "{}, every {save} s: {kills}, {torn}, {maps}; {:.2} s, {:.2} s, {:.3} s",
            sweep.name,
            cpu / maps as f64,
            sweep.undisturbed_cpu(),
            (cpu - maps as f64 * sweep.undisturbed_cpu()) / kills.max(1) as f64
        );
    }
}
