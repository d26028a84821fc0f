//! What a compiler could do that obeys the author of a sketch: a shell script takes its place, and tries.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests too")]

use crate::limits::Limits;
use crate::sandbox::Sandbox;
use crate::{BOARDS, Compiler, SketchError, Source, Toolchain};
use std::fs;
use std::os::unix::fs::{FileTypeExt, PermissionsExt};
use std::path::PathBuf;
use std::time::Duration;
use tempfile::TempDir;

/// Little, so that what takes too much is over soon.
const LIMITS: Limits = Limits {
    time: Duration::from_secs(20),
    memory_mb: 128,
    processes: 40,
    file_mb: 1,
    output: 64 << 10,
};
/// What every script begins with: programs are found, `$out` is its product, `$step` what it does, and `product` leaves
/// a good one.
const BEGIN: &str = r#"#!/bin/sh
PATH=/usr/sbin:/usr/bin:/sbin:/bin step=link
for arg; do
    case "$arg" in --version | -print*) exit 0 ;; -c) step=compile ;; esac
    [ "$last" = -o ] && out=$arg
    last=$arg
done
product() { echo "$step" >"$out"; }
wrong() { echo "a.ino:1:1: error: $1" >&2; exit 1; }
"#;

struct Bench {
    folder: TempDir,
    compiler: Compiler,
    /// A file that no compilation may change.
    victim: PathBuf,
}

/// A compiler that is a script; `None` where there is no sandbox. The script is told the victim's path as `VICTIM`.
fn bench(script: &str, is_walled: bool) -> Option<Bench> {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for inner in ["bin", "core/cores/arduino", "core/variants/mega"] {
        fs::create_dir_all(at(inner)).unwrap();
    }
    let (gcc, victim) = (at("bin/avr-gcc"), at("victim"));
    fs::write(&victim, "whole").unwrap();
    let script = script.replace("VICTIM", victim.to_str().unwrap());
    fs::write(&gcc, format!("{BEGIN}{script}")).unwrap();
    // The core has no files.
    fs::write(at("bin/avr-gcc-ar"), "#!/bin/sh\necho core >\"$2\"\n").unwrap();
    for tool in [&gcc, &at("bin/avr-gcc-ar")] {
        fs::set_permissions(tool, fs::Permissions::from_mode(0o755)).unwrap();
    }
    let system = ["/usr", "/bin", "/lib", "/lib64"].map(PathBuf::from);
    let visible = system.into_iter().filter(|path| path.exists());
    let toolchain = Toolchain {
        gcc,
        core: at("core"),
        libraries: Vec::new(),
        visible: visible.chain([at("bin")]).collect(),
        compiler: "1".into(),
        core_version: "1".into(),
    };
    let sandbox = match is_walled {
        false => Ok(Sandbox::trusting(LIMITS)),
        true => Sandbox::walled(&toolchain, LIMITS),
    };
    let sandbox = match sandbox {
        Ok(sandbox) => sandbox,
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            return None;
        }
    };
    let compiler = Compiler::new(BOARDS[0], toolchain, sandbox, at("cache")).unwrap();
    Some(Bench {
        compiler,
        victim,
        folder,
    })
}

impl Bench {
    /// What became of a sketch: the image's bytes, or why there is none. Nothing is left but what was there.
    fn compile(&self) -> Result<String, SketchError> {
        let text = b"void setup() { }\nvoid loop() { }\n".to_vec();
        let source = Source {
            name: "a".into(),
            files: [("a.ino".into(), text)].into(),
        };
        let image = self.compiler.compile(&source, &[]);
        assert_eq!(fs::read_to_string(&self.victim).unwrap(), "whole");
        let inside = fs::read_dir(self.folder.path().join("cache")).unwrap();
        for entry in inside.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            assert!(!name.starts_with("build-"), "{name}");
            if name.starts_with("core-") {
                assert_eq!(fs::read_to_string(entry.path()).unwrap(), "core\n");
            }
        }
        image.map(|image| {
            let about = image.path.symlink_metadata().unwrap();
            assert!(about.is_file() && !about.file_type().is_fifo());
            fs::read_to_string(image.path).unwrap()
        })
    }
}

#[test]
fn behind_walls_nothing_can_be_written_but_the_product() {
    let script = r#"
core=
for arg; do case "$arg" in *core-*.a) core=$arg ;; esac; done
for path in /x /usr/x /build/x /build/sketch/x /build/sketch/a.ino /build/main/x /build/out/x /dev/x "$0" $core; do
    (echo x >>"$path") 2>/dev/null && wrong "wrote $path"
    rm -f "$path" 2>/dev/null && [ -e "$path" ] && wrong "removed $path"
done
for root in / /build /usr /dev; do mount -o remount,rw $root 2>/dev/null && wrong "remounted $root"; done
umount /build 2>/dev/null && wrong "unmounted"
unshare -Ur true 2>/dev/null && wrong "has a namespace of its own"
mknod /tmp/disk b 254 0 2>/dev/null && wrong "made a device"
rm -f "$out" 2>/dev/null && wrong "removed its product"
mv "$out" /tmp 2>/dev/null && wrong "moved its product"
ln "$out" /tmp/x 2>/dev/null && wrong "linked its product"
ln -sf VICTIM "$out" 2>/dev/null && wrong "replaced its product"
ls /proc/1 2>/dev/null && wrong "sees processes"
product
"#;
    let Some(bench) = bench(script, true) else {
        return;
    };
    assert_eq!(bench.compile().unwrap(), "link\n");
}

#[test]
fn what_is_left_in_a_product_s_place_is_not_followed() {
    for step in ["compile", "link"] {
        for left in [
            "ln -s VICTIM $out",
            "ln -s /dev/zero $out",
            "ln -s $out $out",
            "ln VICTIM $out",
            "mkfifo $out",
            "mkdir $out",
            ":",
        ] {
            let script = format!("[ $step = {step} ] || {{ product; exit 0; }}\n{left}\n");
            let bench = bench(&script, false).unwrap();
            let error = bench.compile().unwrap_err();
            assert!(
                matches!(&error, SketchError::Refused(why) if why.contains("no product")),
                "{step}, {left}: {error}"
            );
        }
    }
}

#[test]
fn more_than_a_compiler_takes_is_not_given() {
    for (script, what) in [
        ("while :; do sleep 60 & done", "more than 40 processes"),
        (
            "for n in 1 2 3 4 5 6; do (a=x; while [ ${#a} -lt 30000000 ]; do a=$a$a; done; sleep 60) & done; wait",
            "more than 128 MB of memory",
        ),
    ] {
        let Some(bench) = bench(script, true) else {
            return;
        };
        let error = bench.compile().unwrap_err();
        assert!(
            matches!(&error, SketchError::Exceeded(why) if why.contains(what)),
            "{script}: {error}"
        );
    }
    // 4 MB for what is between and the system's own blocks, 1 MB for a file.
    let script = r#"
for n in 1 2 3 4 5 6 7 8; do (yes >/tmp/$n) 2>/dev/null; done
size=$(du -sk /tmp | cut -f1)
[ "$size" -gt 5000 ] && wrong "wrote $size kB"
(yes >"$out") 2>/dev/null
[ "$(stat -c %s "$out")" -gt 1048576 ] && wrong "wrote more than a file may hold"
product
"#;
    let Some(bench) = bench(script, true) else {
        return;
    };
    assert_eq!(bench.compile().unwrap(), "link\n");
}
