//! Source that is written against the compiler: it reads nothing but its own, and ends in time.
#![cfg(test)]
#![cfg(target_os = "linux")]

use rumbo_sketch::limits::Limits;
use rumbo_sketch::sandbox::Sandbox;
use rumbo_sketch::{BOARDS, Compiler, SketchError, Source, Toolchain};
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;

/// Little time, so that what never ends is over soon.
const LIMITS: Limits = Limits {
    time: Duration::from_secs(10),
    memory_mb: 512,
    processes: 40,
    file_mb: 16,
    output: 64 << 10,
};

/// `None` where compiler or sandbox are not installed.
fn compiler() -> Option<(Compiler, TempDir)> {
    let found = Toolchain::find().and_then(|toolchain| {
        let sandbox = Sandbox::walled(&toolchain, LIMITS)?;
        Ok((toolchain, sandbox))
    });
    let (toolchain, sandbox) = match found {
        Ok(found) => found,
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            return None;
        }
    };
    let cache = tempfile::tempdir().unwrap();
    let compiler = Compiler::new(BOARDS[0], toolchain, sandbox, cache.path().to_owned()).unwrap();
    Some((compiler, cache))
}

fn sketch(text: &str) -> Source {
    Source {
        name: "bad".into(),
        files: [("bad.ino".to_owned(), text.into())].into(),
    }
}

const REST: &str = "\nvoid setup() { }\nvoid loop() { }\n";

fn compile(compiler: &Compiler, text: &str) -> Result<(), SketchError> {
    let text = format!("{text}{REST}");
    compiler.compile(&sketch(&text), &[]).map(|_| ())
}

#[test]
fn a_sketch_compiles_behind_walls() {
    let Some((compiler, _cache)) = compiler() else {
        return;
    };
    compile(&compiler, "#include <Servo.h>\nServo servo;").unwrap();
    compile(&compiler, "#include <SPI.h>").unwrap();
}

#[test]
fn no_file_of_the_system_can_be_included_or_probed() {
    let Some((compiler, cache)) = compiler() else {
        return;
    };
    let secret = cache.path().join("secret.h");
    std::fs::write(&secret, "#error SECRET\n").unwrap();
    let other = tempfile::tempdir().unwrap();
    std::fs::write(other.path().join("secret.h"), "#error SECRET\n").unwrap();
    for path in [
        Path::new("/etc/passwd"),
        Path::new("/proc/self/environ"),
        Path::new("/etc/hostname"),
        Path::new("/usr/bin/env"),
        &secret,
        &other.path().join("secret.h"),
        Path::new("../../secret.h"),
    ] {
        let path = path.display();
        let error = compile(&compiler, &format!("#include \"{path}\"")).unwrap_err();
        let error = error.to_string();
        assert!(error.contains("No such file"), "{error}");
        compile(
            &compiler,
            &format!("#if __has_include(\"{path}\")\n#error it is there\n#endif"),
        )
        .unwrap();
        let assembly =
            format!("asm(\".section .progmem.data\\n .incbin \\\"{path}\\\"\\n .text\");");
        let error = compile(&compiler, &assembly).unwrap_err().to_string();
        assert!(
            !error.contains("root:") && !error.contains("SECRET"),
            "{error}"
        );
    }
}

#[test]
fn what_never_ends_is_ended_and_leaves_nothing_behind() {
    let Some((compiler, cache)) = compiler() else {
        return;
    };
    for text in [
        // 2^60 instances.
        "template<unsigned long long N, int D> struct T { static const int v = T<2 * N, D - 1>::v + T<2 * N + 1, D - 1>::v; };\n\
         template<unsigned long long N> struct T<N, 0> { static const int v = 1; };\nint x = T<1, 60>::v;",
        // 2^190 times the file.
        "#if __INCLUDE_LEVEL__ < 190\n#include \"bad.ino\"\n#include \"bad.ino\"\n#endif",
        // As much of memory.
        "#define A(x) x x x x x x x x x x\n#define B(x) A(A(A(A(A(x)))))\nconst char t[] = B(B(B(\"x\")));",
    ] {
        let error = compile(&compiler, text).unwrap_err();
        assert!(
            matches!(error, SketchError::Exceeded(_) | SketchError::Rejected(_)),
            "{error}"
        );
    }
    let left = std::fs::read_dir(cache.path()).unwrap().flatten();
    let left: Vec<_> = left
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with("build-"))
        .collect();
    assert_eq!(left, [""; 0]);
}

#[test]
fn no_disk_is_filled_and_no_page_of_errors_either() {
    let Some((compiler, _cache)) = compiler() else {
        return;
    };
    let error = compile(
        &compiler,
        "asm(\".section .progmem.data\\n .fill 2000000000, 1, 7\\n .text\");",
    );
    assert!(error.is_err());
    let flood: String = (0..50_000)
        .map(|n| format!("#warning {n} flood\n"))
        .collect();
    // Warnings alone keep no sketch from being one.
    compile(&compiler, &flood).unwrap();
    let flood: String = (0..50_000).map(|n| format!("#error {n} flood\n")).collect();
    let error = compile(&compiler, &flood).unwrap_err().to_string();
    assert!(error.lines().count() < 60, "{}", error.lines().count());
}

/// A library for this computer, which says that it was loaded.
fn plugin(folder: &Path) -> Vec<u8> {
    let (text, library) = (folder.join("plug.c"), folder.join("plug.so"));
    let said = "#include <stdio.h>\nint plugin_is_GPL_compatible;\n\
                __attribute__((constructor)) static void loaded(void) { fprintf(stderr, \"a.ino:1:1: error: LOADED\\n\"); }\n\
                int plugin_init(void *a, void *b) { return 0; }\n";
    std::fs::write(&text, said).unwrap();
    let mut cc = std::process::Command::new("cc");
    cc.args(["-shared", "-fPIC", "-o"]).args([&library, &text]);
    assert!(cc.status().unwrap().success());
    std::fs::read(&library).unwrap()
}

#[test]
fn a_hand_in_gives_the_compiler_no_orders() {
    let Some((compiler, cache)) = compiler() else {
        return;
    };
    let file = |name: &str, text: &[u8]| (name.to_owned(), text.to_vec());
    let ino = file("x.ino", REST.as_bytes());
    let source = Source {
        name: "x".into(),
        files: [
            ino.clone(),
            file("@args.cpp", b""),
            file("args.cpp", b"//build/sketch/stub.cpp -fplugin=./plug.inc"),
            file("stub.cpp", b""),
            file("plug.inc", &plugin(cache.path())),
        ]
        .into(),
    };
    let error = compiler.compile(&source, &[]).unwrap_err().to_string();
    assert!(
        error.starts_with("@args.cpp: a sketch has no file of this name"),
        "{error}"
    );
    for name in ["--help.c", "-fplugin=plug.c", "-.cpp", "src/@args.S"] {
        let files = [ino.clone(), file(name, b"")].into();
        let source = Source {
            name: "x".into(),
            files,
        };
        let error = compiler.compile(&source, &[]).unwrap_err().to_string();
        assert!(error.contains("no file of this name"), "{name}: {error}");
    }
}
