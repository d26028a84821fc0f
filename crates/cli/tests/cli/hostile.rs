//! A class of hostile hand-ins: what they are called, what they consist of, and what their source makes a compiler do.
//! None writes anywhere, reads what is not its own, keeps the others from their marks, or earns a point; each is told
//! what is wrong with it.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic)]

use super::grade::{assignment, bench, bytes, results};
use crate::support;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output};
use support::{folder, program, stderr};

const REST: &str = "\nvoid setup() { }\nvoid loop() { }\n";
const NO_NAME: &str = "a sketch has no file of this name";
/// It is a sketch, and does nothing.
const IDLE: &str = "it never drove a motor";
const NO_SKETCH: &str = "no sketch here";
const NOT_THERE: &str = "No such file or directory";
const TOO_MANY: &str =
    "more than 2000 files in a folder of the sketch or in all, or folders more than 6 deep";

/// A sketch with one more file: the hand-in, the file's name, and what is said.
const NAMES: [(&str, &[u8], &str); 17] = [
    ("response file", b"@args.cpp", NO_NAME),
    ("response file below", b"src/@args.S", NO_NAME),
    ("an option", b"--help.c", NO_NAME),
    ("a plugin by name", b"-fplugin=x.c", NO_NAME),
    ("an option for a folder", b"src/-I..-I/x.cpp", NO_NAME),
    ("newline", b"a\nb.cpp", NO_NAME),
    ("quote", b"a\"b.cpp", NO_NAME),
    ("backslash", b"a\\b.h", NO_NAME),
    ("shell", b"$(touch owned).cpp", NO_NAME),
    ("format", b"%s%n.c", NO_NAME),
    ("terminal", b"\x1b[2J.h", NO_NAME),
    ("other direction", "a\u{202e}h.cpp".as_bytes(), NO_NAME),
    ("not a text", b"\xff\xfe.cpp", NO_NAME),
    ("very long", &[b'a'; 253], NO_NAME),
    ("a name of ours", b"rumbo~1.cpp", NO_NAME),
    ("hidden", b".hidden.cpp", IDLE),
    ("spaces and options", b"a -x c -o ..cpp", IDLE),
];

/// A hand-in of these files, and what is said.
type Make = fn(&Path, &Path);
const FILES: [(&str, Make, &str); 20] = [
    (
        "plugin",
        |at, _| {
            put(at, "@args.cpp", "");
            put(
                at,
                "args.cpp",
                "//build/sketch/stub.cpp -fplugin=./plug.inc",
            );
            put(at, "stub.cpp", "");
            fs::write(at.join("plug.inc"), plugin(at)).unwrap();
            sketch(at, "");
        },
        NO_NAME,
    ),
    ("nameless", |at, _| put(at, "@x.ino", REST), NO_NAME),
    (
        "linked file",
        |at, victim| {
            symlink(victim, at.join("secret.h")).unwrap();
            sketch(at, "#include \"secret.h\"");
        },
        NOT_THERE,
    ),
    (
        "linked folder",
        |at, victim| {
            symlink(victim.parent().unwrap(), at.join("src")).unwrap();
            sketch(at, "#include \"src/victim.h\"");
        },
        NOT_THERE,
    ),
    (
        "linked sketch",
        |at, victim| symlink(victim, at.join("x.ino")).unwrap(),
        NO_SKETCH,
    ),
    (
        "linked image",
        |at, victim| symlink(victim, at.join("x.elf")).unwrap(),
        NO_SKETCH,
    ),
    (
        "loop of links",
        |at, _| {
            symlink(at.join("b.h"), at.join("a.h")).unwrap();
            symlink(at.join("a.h"), at.join("b.h")).unwrap();
            symlink(".", at.join("src")).unwrap();
            sketch(at, "#include \"a.h\"");
        },
        NOT_THERE,
    ),
    (
        "dangling link",
        |at, _| {
            symlink("nowhere", at.join("a.h")).unwrap();
            sketch(at, "#include \"a.h\"");
        },
        NOT_THERE,
    ),
    (
        "hard link",
        |at, victim| {
            fs::hard_link(victim, at.join("own.h")).unwrap();
            sketch(at, "#include \"own.h\"");
        },
        "SECRET",
    ),
    (
        "fifo",
        |at, _| {
            made(Command::new("mkfifo").arg(at.join("a.h")));
            sketch(at, "#include \"a.h\"");
        },
        NOT_THERE,
    ),
    (
        "fifo for a sketch",
        |at, _| made(Command::new("mkfifo").arg(at.join("x.ino"))),
        NO_SKETCH,
    ),
    (
        "device",
        |at, _| {
            // Only root can make one.
            let _ = Command::new("mknod")
                .arg(at.join("a.h"))
                .args(["c", "1", "5"])
                .output();
            sketch(at, "#include \"a.h\"");
        },
        NOT_THERE,
    ),
    (
        "deep",
        |at, _| {
            fs::create_dir_all(at.join(["d"; 300].join("/"))).unwrap();
            sketch(at, "");
        },
        TOO_MANY,
    ),
    (
        "many",
        |at, _| {
            (0..2_100).for_each(|n| put(at, &format!("{n}.h"), ""));
            sketch(at, "");
        },
        TOO_MANY,
    ),
    (
        "many sketches",
        |at, _| {
            for n in 0..300 {
                sparse(&folder_in(at, &n.to_string()).join("x.ino"), 8 << 20);
            }
        },
        NO_SKETCH,
    ),
    (
        "giant",
        |at, _| {
            sparse(&at.join("a.h"), 1 << 40);
            sketch(at, "");
        },
        "a.h: the sketch has more than 8 MB",
    ),
    (
        "giant image",
        |at, _| sparse(&at.join("x.elf"), 1 << 40),
        "no image of a size",
    ),
    (
        "many headers",
        |at, _| {
            let text = (0..300_000).map(|n| format!("#include <H{n}.h>\n"));
            sketch(at, &text.collect::<String>());
        },
        "includes more than 10000 different headers",
    ),
    (
        "braces",
        |at, _| {
            // Preprocessing took hours.
            put(
                at,
                "x.ino",
                &format!("{REST}{}{}", " ".repeat(800_000), "{".repeat(800_000)),
            );
        },
        "error",
    ),
    (
        "linker script",
        |at, _| {
            put(at, "link.ld", "INPUT(/etc/passwd) OUTPUT(/tmp/owned)");
            put(at, "src/link.S", "INPUT(/etc/passwd)\n");
            sketch(at, "");
        },
        "link.S",
    ),
];

/// A sketch that keeps the compiler busy until its time is over.
const ENDLESS: [(&str, &str); 3] = [
    (
        "templates",
        "template<unsigned long long N, int D> struct T { static const int v = T<2 * N, D - 1>::v + T<2 * N + 1, D - 1>::v; };\n\
      template<unsigned long long N> struct T<N, 0> { static const int v = 1; };\nint x = T<1, 60>::v;",
    ),
    (
        "includes",
        "#if __INCLUDE_LEVEL__ < 190\n#include \"x.ino\"\n#include \"x.ino\"\n#endif",
    ),
    (
        "constants for ever",
        "constexpr unsigned long f(unsigned long n, int d) { return d ? f(2 * n, d - 1) + f(2 * n + 1, d - 1) : n; }\n\
      constexpr unsigned long x = f(1, 60);",
    ),
];

/// What lies in the class and is nobody's hand-in.
const NONE: [&str; 3] = ["linked", "pipe.ino", "..ana"];

const SCENARIO: &str = "title = \"Wheels\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\n\
    mode = \"wheel_speed\"\nduration_s = 3\n[[command]]\nat_s = 0.4\nspeed_rpm = 60\n[[command]]\nat_s = 0.5\narm = true\n";
const ASSIGNMENT: &str = "title = \"T\"\nstatement = \"S\"\npoints = 10\n[[scenario]]\nscenario = \"scenario.toml\"\n\
    wiring = \"modes_5_to_7\"\npublic_seeds = [1]\n[[criterion]]\ntitle = \"C\"\nmetric = \"step1.settling_s\"\n\
    points = 1\nfull = 2.0\nnone = 2.9\n";

fn put(at: &Path, name: &str, text: &str) {
    let path = at.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

fn sketch(at: &Path, text: &str) {
    put(at, "x.ino", &format!("{text}{REST}"));
}

fn folder_in(at: &Path, name: &str) -> std::path::PathBuf {
    let folder = at.join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn sparse(path: &Path, bytes: u64) {
    File::create(path).unwrap().set_len(bytes).unwrap();
}

fn made(command: &mut Command) {
    assert!(command.status().unwrap().success());
}

/// A library for this computer that says that it was loaded.
fn plugin(at: &Path) -> Vec<u8> {
    let place = tempfile::tempdir_in(at.parent().unwrap().parent().unwrap()).unwrap();
    let (text, library) = (place.path().join("plug.c"), place.path().join("plug.so"));
    let said = "#include <stdio.h>\nint plugin_is_GPL_compatible;\n\
                __attribute__((constructor)) static void loaded(void) { fprintf(stderr, \"x.ino:1:1: error: LOADED\\n\"); }\n\
                int plugin_init(void *a, void *b) { return 0; }\n";
    fs::write(&text, said).unwrap();
    made(
        Command::new("cc")
            .args(["-shared", "-fPIC", "-o"])
            .args([&library, &text]),
    );
    fs::read(&library).unwrap()
}

/// Grades the class `within` in at most so many seconds of compiling each.
fn grade(bench: &Path, within: &str, out: &str, compile_s: u32) -> Output {
    let text = format!("compile_s = {compile_s}\n{ASSIGNMENT}");
    fs::write(bench.join("assignment.toml"), text).unwrap();
    let mut command = program();
    command.current_dir(bench);
    command.args([
        "grade",
        "assignment.toml",
        within,
        "--out",
        out,
        "--language",
        "en",
    ]);
    command.env("RUMBO_CACHE", folder().join("sketches"));
    command.env("TMPDIR", bench.join("tmp"));
    command.output().unwrap()
}

#[test]
fn no_hostile_hand_in_leaves_its_place_or_earns_a_point_and_each_is_told_why() {
    let Some(bench) = bench("doors") else {
        return;
    };
    fs::create_dir_all(bench.join("tmp")).unwrap();
    fs::write(bench.join("scenario.toml"), SCENARIO).unwrap();
    let victim = bench.join("victim.h");
    fs::write(&victim, "#error SECRET\n").unwrap();
    let model = fs::read_to_string(assignment("speed").join("model/model.ino")).unwrap();
    for class in ["alone", "in", "endless"] {
        put(&bench, &format!("{class}/honest/model.ino"), &model);
    }
    let alone = grade(&bench, "alone", "out_alone", 60);
    assert_eq!(alone.status.code(), Some(0), "{}", stderr(&alone));

    let class = bench.join("in");
    let mut expected: Vec<(&str, &str)> = Vec::new();
    for (name, file, said) in NAMES {
        let at = folder_in(&class, name);
        sketch(&at, "");
        let ending: &[u8] = if file.contains(&b'.') { b"" } else { b".h" };
        let file = at.join(OsStr::from_bytes(&[file, ending].concat()));
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, "").unwrap();
        expected.push((name, said));
    }
    let sources: toml::Table = include_str!("../programs/hostile.toml").parse().unwrap();
    assert_eq!(sources.len(), 30);
    for (name, source) in &sources {
        let [text, said] = ["text", "said"].map(|key| source[key].as_str().unwrap());
        let at = folder_in(&class, name);
        sketch(&at, text);
        if text.contains("plug.inc") {
            fs::write(at.join("plug.inc"), plugin(&at)).unwrap();
        }
        expected.push((name, said));
    }
    for (name, make, said) in FILES {
        make(&folder_in(&class, name), &victim);
        expected.push((name, said));
    }
    fs::write(class.join("archive.zip"), "PK").unwrap();
    expected.push(("archive", "no zip archive"));
    symlink("/etc", class.join("linked")).unwrap();
    made(Command::new("mkfifo").arg(class.join("pipe.ino")));
    sketch(&folder_in(&class, "..ana"), "");
    let endless = bench.join("endless");
    for (name, text) in ENDLESS {
        sketch(&folder_in(&endless, name), text);
    }
    let text = format!("int x = {}1{};", "(".repeat(200_000), ")".repeat(200_000));
    sketch(&folder_in(&endless, "parentheses"), &text);
    let before = listing(&bench);

    let graded = grade(&bench, "in", "out", 60);
    assert_eq!(graded.status.code(), Some(1), "{}", stderr(&graded));
    for name in NONE {
        let said = stderr(&graded);
        assert!(said.contains(name), "{name} in {said}");
    }
    let results = results(&bench.join("out"));
    assert_eq!(results.len(), expected.len() + 1);
    let mut wrong = Vec::new();
    for (name, said) in expected {
        let file: String = name.replace(' ', "_");
        let result = &results[&file];
        let output = result["output"].as_str().unwrap();
        if result["score"] != 0.0 || !output.contains(said) {
            wrong.push(format!("{name}: {result:#}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));

    // Two seconds for each of those that would take all there are.
    let graded = grade(&bench, "endless", "out_endless", 2);
    assert_eq!(graded.status.code(), Some(1), "{}", stderr(&graded));
    let late = super::grade::results(&bench.join("out_endless"));
    assert_eq!(late.len(), ENDLESS.len() + 2);
    for (name, _) in ENDLESS.into_iter().chain([("parentheses", "")]) {
        let result = &late[&name.replace(' ', "_")];
        assert!(result["score"] == 0.0, "{name}: {result}");
        let output = result["output"].as_str().unwrap();
        assert!(
            output.contains("not done after 2 s")
                || output.contains("Killed")
                || output.contains("CPU"),
            "{name}: {output}"
        );
    }

    // The honest one has the same page, to the byte, whoever is graded beside it.
    for file in ["students/honest.html", "gradescope/honest.json"] {
        let read = |out: &str| fs::read(bench.join(out).join(file)).unwrap();
        assert!(
            read("out_alone") == read("out") && read("out") == read("out_endless"),
            "{file}"
        );
    }
    assert_eq!(results["honest"]["score"], 10.0);
    // Nothing is anywhere that was not there, but the results, and they tell nothing that is not theirs.
    assert_eq!(before, listing(&bench));
    for (file, bytes) in bytes(&bench.join("out")) {
        let text = String::from_utf8(bytes).unwrap();
        for part in ["LOADED", "root:", "\x1b", bench.to_str().unwrap()] {
            // Texts that are alike are shown as they were handed in.
            let is_own = part == "LOADED" && file.starts_with("similar");
            assert!(is_own || !text.contains(part), "{part:?} in {file:?}");
        }
    }
}

/// Every file with its size, and what links lead to, but for the results and the assignment.
fn listing(bench: &Path) -> Vec<String> {
    let command = r#"find . -mindepth 1 -not -path './out*' -not -name assignment.toml -printf '%p %y %s %l %n\n' | sort"#;
    let found = Command::new("sh")
        .current_dir(bench)
        .args(["-c", command])
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&found.stdout).into_owned();
    text.lines().map(str::to_owned).collect()
}
