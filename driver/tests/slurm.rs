//! A sweep as an array of jobs of a real SLURM on this machine, of which one job is cancelled in the middle.
//!
//! munged, slurmctld and slurmd run with folders of their own. Where they are not installed, or it is not root who asks
//! (slurmd starts jobs as their user), the test says so and passes; with PULLOUT_REQUIRE_CLIENTS it fails.

#[path = "program/mod.rs"]
mod program;

use program::{Desk, command};
use pullout_sweep::table::{Column, Table};
use serde_json::json;
use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(60);
const COUNT: usize = 64;
const JOBS: usize = 4;

/// The daemons, ended with the test.
struct Cluster {
    daemons: Vec<Child>,
    configuration: PathBuf,
}

impl Drop for Cluster {
    fn drop(&mut self) {
        for daemon in self.daemons.iter_mut().rev() {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

fn free_port() -> u16 {
    std::net::TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a port").port()
}

fn wait(what: &str, mut is_there: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_there() {
        assert!(start.elapsed() < PATIENCE, "{what} did not happen in {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

impl Cluster {
    fn start(folder: &Path) -> Self {
        for name in ["munge", "state", "spool"] {
            fs::create_dir(folder.join(name)).expect("a folder");
            fs::set_permissions(folder.join(name), fs::Permissions::from_mode(0o755)).expect("permissions");
        }
        let path = |name: &str| folder.join(name).display().to_string();
        fs::write(path("munge/key"), [7_u8; 128]).expect("written");
        fs::set_permissions(path("munge/key"), fs::Permissions::from_mode(0o400)).expect("permissions");
        let host = fs::read_to_string("/proc/sys/kernel/hostname").expect("a name");
        let (host, socket) = (host.trim(), path("munge/socket"));
        let settings = format!(
            "ClusterName=test\nSlurmctldHost={host}(127.0.0.1)\nSlurmctldPort={}\nSlurmdPort={}\nSlurmUser=root\n\
             SlurmdUser=root\nAuthType=auth/munge\nAuthInfo=socket={socket}\nCredType=cred/munge\nMpiDefault=none\n\
             ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nReturnToService=2\nSwitchType=switch/none\n\
             StateSaveLocation={}\nSlurmdSpoolDir={}\nSlurmctldPidFile={}\nSlurmdPidFile={}\nSlurmctldLogFile={}\n\
             SlurmdLogFile={}\nSchedulerType=sched/builtin\n\
             SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0\nSelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n\
             AccountingStorageType=accounting_storage/none\nJobAcctGatherType=jobacct_gather/none\nKillWait=1\n\
             SlurmdParameters=config_overrides\nJobCompType=jobcomp/none\n\
             NodeName={host} NodeAddr=127.0.0.1 CPUs={JOBS} State=UNKNOWN\n\
             PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP\n",
            free_port(),
            free_port(),
            path("state"),
            path("spool"),
            path("slurmctld.pid"),
            path("slurmd.pid"),
            path("slurmctld.log"),
            path("slurmd.log"),
        );
        let configuration = folder.join("slurm.conf");
        fs::write(&configuration, settings).expect("written");
        let mut cluster = Self { daemons: Vec::new(), configuration };
        let munged = [
            "--foreground".to_owned(),
            "--force".into(),
            format!("--socket={socket}"),
            format!("--key-file={}", path("munge/key")),
            format!("--pid-file={}", path("munge/pid")),
            format!("--seed-file={}", path("munge/seed")),
            format!("--log-file={}", path("munge/log")),
        ];
        cluster.daemon("munged", &munged);
        wait("munged", || Path::new(&socket).exists());
        cluster.daemon("slurmctld", &["-D".into(), "-i".into()]);
        cluster.daemon("slurmd", &["-D".into()]);
        wait("a node that waits for work", || cluster.ask("sinfo", &["-h", "-o", "%t"]).trim() == "idle");
        cluster
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("SLURM_CONF", &self.configuration).stdin(Stdio::null());
        command
    }

    fn daemon(&mut self, program: &str, arguments: &[String]) {
        let mut command = self.command(program);
        let log = fs::File::create(self.configuration.with_file_name(format!("{program}.out"))).expect("a file");
        command.args(arguments).stdout(log.try_clone().expect("a file")).stderr(log);
        self.daemons.push(command.spawn().expect("it starts"));
    }

    fn ask(&self, program: &str, arguments: &[&str]) -> String {
        let output = self.command(program).args(arguments).output().expect("it starts");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Submits a script and returns the number of the job.
    fn submit(&self, script: &Path, folder: &Path) -> String {
        let mut sbatch = self.command("sbatch");
        let program = Path::new(env!("CARGO_BIN_EXE_pullout")).parent().expect("a folder");
        let search = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
        let output = sbatch.arg("--parsable").arg(script).current_dir(folder).env("PATH", search).output();
        let output = output.expect("sbatch starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).trim().to_owned()
    }

    fn ended(&self, job: &str) {
        wait("the end of a job", || self.ask("squeue", &["-h", "-j", job]).trim().is_empty());
    }
}

fn is_installed() -> bool {
    let there = |program: &str| Command::new(program).arg("-V").output().is_ok();
    ["munged", "slurmctld", "slurmd", "sbatch"].into_iter().all(there) && is_root()
}

fn is_root() -> bool {
    fs::metadata("/proc/self").is_ok_and(|of| std::os::unix::fs::MetadataExt::uid(&of) == 0)
}

fn parts(store: &Path) -> impl Iterator<Item = PathBuf> {
    let parts = fs::read_dir(store.join("parts")).into_iter().flatten().flatten().map(|part| part.path());
    parts.filter(|part| part.extension().is_some_and(|extension| extension == "jsonl"))
}

/// The number of the first run of a part, with which its name begins.
fn first_run(part: &Path) -> usize {
    let name = part.file_name().unwrap_or_default().to_string_lossy();
    name.split('-').next().and_then(|number| number.parse().ok()).unwrap_or(usize::MAX)
}

fn keys(store: &Path) -> Vec<String> {
    let keys = |part: PathBuf| match Table::read(&part, |name| name == "key").expect("a part").column("key") {
        Some(Column::Text(keys)) => keys.iter().flatten().cloned().collect::<Vec<String>>(),
        _ => Vec::new(),
    };
    parts(store).flat_map(keys).collect()
}

#[test]
fn an_array_of_jobs_of_which_one_is_cancelled() {
    if !is_installed() {
        assert!(std::env::var_os("PULLOUT_REQUIRE_CLIENTS").is_none(), "munge, slurmctld, slurmd and root are needed");
        eprintln!("not tested: needs munge, slurmctld, slurmd, slurm-client, and root");
        return;
    }
    let desk = Desk::new();
    let moduli: Vec<f64> = (0..COUNT).map(|k| 700.0 + k as f64).collect();
    let base = json!({
        "kind": "interface",
        "material": { "plugin": "bond_slip", "props": { "law": "A", "k_e": 950.0, "a_1": 10.0, "b_1": 0.4 } },
        "steps": [{ "increments": 20000, "target": { "slip": 1.0 } }],
    });
    let sweep = json!({ "kind": "sweep", "title": "bonds", "base": base, "parameters": { "material.props.k_e": moduli },
        "quantities": { "first": { "column": "tau", "at": 0.0001 } } });
    let store = desk.path("store");
    let file = desk.case("sweep.json", &sweep);
    desk.pullout(["sweep".as_ref(), "plan".as_ref(), file.as_os_str(), "--out".as_ref(), store.as_os_str()]).expect(0);
    let script = desk
        .pullout([
            "sweep".as_ref(),
            "submit".as_ref(),
            store.as_os_str(),
            "--slurm".as_ref(),
            "--array".as_ref(),
            "0-3".as_ref(),
        ])
        .expect(0);
    // rows are written often, so that something is done of the job that is cancelled
    let script = desk.write("job.sh", &script.stdout.replace("--quiet", "--quiet --chunk-runs 2"));

    let place = desk.path("cluster");
    fs::create_dir(&place).expect("a folder");
    let cluster = Cluster::start(&place);
    let job = cluster.submit(&script, &place);
    let third = format!("{job}_2");
    let of_third = COUNT / JOBS * 2..COUNT / JOBS * 3;
    wait("rows of the job that is cancelled", || parts(&store).any(|part| of_third.contains(&first_run(&part))));
    cluster.ask("scancel", &[&third]);
    cluster.ended(&job);
    let done = keys(&store).len();
    assert!((COUNT / JOBS * 3 + 1..COUNT).contains(&done), "{done} rows: one of four jobs was cancelled in the middle");

    // the same script does what is left
    let again = cluster.submit(&script, &place);
    cluster.ended(&again);
    let keys = keys(&store);
    assert_eq!((keys.len(), keys.iter().collect::<BTreeSet<_>>().len()), (COUNT, COUNT));
    let out = desk.path("table.jsonl");
    let collected = command().args(["sweep", "collect"]).arg(&store).arg("--out").arg(&out).status();
    assert!(collected.expect("it starts").success());
    let table = Table::read(&out, |_| true).expect("a table");
    assert_eq!(table.rows(), COUNT);
    for row in 0..COUNT {
        let number = |name: &str| table.column(name).and_then(|column| column.number(row)).expect("a number");
        let expected = 1e-4 * number("par.material.props.k_e");
        assert!((number("q.first") - expected).abs() < 1e-9 * expected, "{row}: {}", number("q.first"));
    }
}
