//! Sketches become images as with the Arduino IDE, and what is wrong with them is said with its place.
#![cfg(test)]

use rumbo_sketch::limits::Limits;
use rumbo_sketch::sandbox::Sandbox;
use rumbo_sketch::{BOARDS, Board, Compiler, SketchError, Source, Toolchain, example, examples};
use tempfile::TempDir;

/// A compiler with a cache of its own; `None` where none is installed.
fn compiler() -> Option<(Compiler, TempDir)> {
    compiler_for(BOARDS[0])
}

fn compiler_for(board: Board) -> Option<(Compiler, TempDir)> {
    let Ok(toolchain) = Toolchain::find() else {
        assert!(std::env::var_os("CI").is_none(), "no avr-gcc");
        return None;
    };
    let cache = tempfile::tempdir().unwrap();
    let sandbox = Sandbox::trusting(Limits::default());
    let compiler = Compiler::new(board, toolchain, sandbox, cache.path().to_owned()).unwrap();
    Some((compiler, cache))
}

fn source(name: &str, files: &[(&str, &str)]) -> Source {
    let files = files.iter();
    Source {
        name: name.into(),
        files: files
            .map(|(name, text)| ((*name).into(), (*text).into()))
            .collect(),
    }
}

fn refused(compiler: &Compiler, source: &Source) -> String {
    match compiler.compile(source, &[]) {
        Err(error @ SketchError::Rejected(_)) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_example_compiles_and_is_fresh_the_second_time() {
    let Some((compiler, _cache)) = compiler() else {
        return;
    };
    for (name, _) in examples() {
        let source = example(&name).unwrap();
        let image = compiler.compile(&source, &[]).unwrap();
        assert!(!image.fresh && image.path.is_file(), "{name}");
        assert_eq!(image.warnings, [], "{name}");
        assert!(compiler.compile(&source, &[]).unwrap().fresh);
    }
}

#[test]
fn a_cache_that_cannot_be_made_is_said_with_the_way_to_another() {
    let Ok(toolchain) = Toolchain::find() else {
        return;
    };
    let file = tempfile::NamedTempFile::new().unwrap();
    let sandbox = Sandbox::trusting(Limits::default());
    let below = file.path().join("sketches");
    let refused = Compiler::new(BOARDS[0], toolchain, sandbox, below);
    let Err(error) = refused else { panic!("made") };
    assert!(error.to_string().contains("RUMBO_CACHE"), "{error}");
}

#[test]
fn the_library_and_a_servo_are_there_on_every_board() {
    let both = "#include <RumboRobot.h>\nRumboRobot robot;\nServo other;\n\
                void setup() { robot.begin(); robot.look(90); other.attach(11); }\nvoid loop() { robot.update(); }\n";
    let sketch = source("both", &[("both.ino", both)]);
    for board in BOARDS {
        let Some((compiler, _cache)) = compiler_for(board) else {
            return;
        };
        assert_eq!(compiler.compile(&sketch, &[]).unwrap().warnings, []);
    }
    let Some((compiler, _cache)) = compiler_for(BOARDS[1]) else {
        return;
    };
    let second = source(
        "second",
        &[(
            "a.ino",
            "void setup() { Serial1.begin(9600); }\nvoid loop() { }\n",
        )],
    );
    let said = refused(&compiler, &second);
    assert!(
        said.contains("'Serial1' was not declared")
            && said.contains("`uno`, which has Serial alone"),
        "{said}"
    );
}

#[test]
fn files_are_joined_functions_declared_and_libraries_found() {
    let Some((compiler, _cache)) = compiler() else {
        return;
    };
    let sketch = source(
        "all",
        &[
            (
                "all.ino",
                "#include <Servo.h>\n#include <EEPROM.h>\nServo servo;\nvoid setup() { servo.attach(9); twice(later()); }\n",
            ),
            (
                "b.ino",
                "int later() { return EEPROM.read(0); }\nvoid loop() { helper(); }\n",
            ),
            ("help.h", "#pragma once\nvoid helper();\n"),
            (
                "src/deep/help.cpp",
                "#include \"../../help.h\"\nvoid helper() { asm volatile(\"nop\"); }\n",
            ),
            (
                "z.ino",
                "#include \"help.h\"\nint twice(int n) { return 2 * n; }\n",
            ),
            ("notes/old.cpp", "#error not compiled\n"),
        ],
    );
    // As in the IDE, what the last file includes is not known to the one before.
    let error = refused(&compiler, &sketch);
    assert!(
        error.starts_with("b.ino:2:22: error: 'helper' was not declared"),
        "{error}"
    );
    let mut mended = sketch;
    mended.files.insert(
        "b.ino".into(),
        "#include \"help.h\"\nint later() { return EEPROM.read(0); }\nvoid loop() { helper(); }\n"
            .into(),
    );
    compiler.compile(&mended, &[]).unwrap();
}

#[test]
fn an_error_names_the_students_file_and_line() {
    let Some((compiler, _cache)) = compiler() else {
        return;
    };
    let main = "void setup() { }\n\nvoid loop() {\n  sped = 3;\n}\n";
    let sketch = source(
        "wall",
        &[("wall.ino", main), ("pid.cpp", "int f() { return\n}\n")],
    );
    assert_eq!(
        refused(&compiler, &sketch),
        "wall.ino:4:3: error: 'sped' was not declared in this scope\n\
         pid.cpp:2:1: error: expected primary-expression before '}' token\n\
         pid.cpp:2:1: error: expected ';' before '}' token"
    );
    let nothing = source(
        "wall",
        &[(
            "wall.ino",
            "void setup() { }\nvoid drive(int);\nvoid f() { drive(1); }\nvoid loop2() { f(); }\n",
        )],
    );
    let error = refused(&compiler, &nothing);
    assert!(
        error.contains("the sketch has no function `void loop()`"),
        "{error}"
    );
}

#[test]
fn the_same_sketch_gives_the_same_program_wherever_it_is_compiled() {
    let (Some((one, _a)), Some((two, _b))) = (compiler(), compiler()) else {
        return;
    };
    let sketch = source(
        "where",
        &[(
            "where.ino",
            "void setup() { Serial.begin(9600); Serial.print(F(__FILE__)); }\nvoid loop() { }\n",
        )],
    );
    let loaded = |compiler: &Compiler| {
        let image = compiler.compile(&sketch, &[]).unwrap();
        let hex = image.path.with_extension("hex");
        let done = std::process::Command::new("avr-objcopy")
            .args(["-O", "ihex"])
            .args([&image.path, &hex])
            .status();
        assert!(done.unwrap().success());
        std::fs::read(hex).unwrap()
    };
    assert_eq!(loaded(&one), loaded(&two));
}

#[test]
fn sources_of_every_kind_and_folder_are_compiled_under_their_own_names() {
    let Some((compiler, _cache)) = compiler() else {
        return;
    };
    let ino = "extern \"C\" int twice(int);\nextern \"C\" int thrice(int);\nconst char *own();\n\
               void setup() { Serial.begin(9600); Serial.print(own()); }\nvoid loop() { Serial.print(twice(thrice(1))); }\n";
    let mut sketch = source(
        "kinds",
        &[
            ("kinds.ino", ino),
            (
                "src/twice.S",
                "#define NAME twice\n.global NAME\nNAME:\n  lsl r24\n  rol r25\n  ret\n",
            ),
            (
                "src/c/thrice.c",
                "#include \"../three.h\"\nint thrice(int n) { return THREE * n; }\n",
            ),
            ("src/three.h", "#define THREE 3\n"),
            (
                "año (1).cpp",
                "\u{feff}#include \"src/three.h\"\nconst char *own() { return __FILE__ \"!\"; }\n",
            ),
        ],
    );
    let image = compiler.compile(&sketch, &[]).unwrap();
    assert_eq!(image.warnings, []);
    let bytes = std::fs::read(image.path).unwrap();
    let own = "año (1).cpp!".as_bytes();
    assert!(bytes.windows(own.len()).any(|part| part == own));

    for (name, text, said) in [
        (
            "src/c/thrice.c",
            "\nint thrice(int n) { return n;\n",
            "src/c/thrice.c:2:1: error: expected declaration or statement at end of input",
        ),
        (
            "src/twice.S",
            "#error no\n",
            "src/twice.S:1:2: error: #error no",
        ),
        (
            "src/c/thrice.c",
            "\nint thrice(int n) { return m; }\n",
            "src/c/thrice.c:2:28: error: 'm' undeclared",
        ),
        (
            "src/three.h",
            "#define THREE +;\n",
            "src/c/../three.h:1:16: error: expected expression before ';' token\n  src/c/thrice.c:2:28: in expansion",
        ),
    ] {
        let before = sketch.files.insert(name.into(), text.into());
        let error = refused(&compiler, &sketch);
        assert!(error.contains(said), "{name}: {error}");
        sketch.files.insert(name.into(), before.unwrap());
    }
}

#[test]
fn functions_are_declared_as_the_ide_declares_them() {
    let Some((compiler, _cache)) = compiler() else {
        return;
    };
    // Used before they are defined: behind a branch that is not compiled, behind braces that balance in neither text,
    // with C linkage, made by a macro, as a template, in another file, and beside what is no function.
    let main = "typedef struct __attribute__((packed)) { byte a; } Packet;\n\
        #if defined(ESP32)\nvoid IRAM_ATTR tick() {}\n#else\nvoid tick() {}\n#endif\n\
        #define FAST 1\n#define HANDLER(name) void name##_now() { PORTB ^= 1; }\n\
        extern \"C\" void bare() { PORTB ^= 128; }\n\
        HANDLER(tock)\n\
        void setup() {\n#if FAST\n  if (millis() > 5) {\n#else\n  if (millis() > 50) {\n#endif\n    later();\n  }\n}\n\
        void loop() { tick(); bare(); tock_now(); far(twice(1)); Packet p; take(p); }\n\
        ISR(TIMER1_OVF_vect) { later(); }\n\
        void later() { wait_a_while(); }\n\
        template <class N> N twice(N n) { return 2 * n; }\n\
        void take(Packet &p) { p.a = 1; }\n\
        void wait_a_while(int ms);\nvoid wait_a_while(int ms = 3) { delay(ms); }\n";
    let main = main.replace("wait_a_while(); }", "tick(); }");
    let other = "void far(int n) { delay(n); }\n";
    let sketch = source("odd", &[("odd.ino", &main), ("z.ino", other)]);
    let image = compiler.compile(&sketch, &[]).unwrap();
    assert_eq!(image.warnings, []);
    // An error has its own line, also where nothing can be preprocessed.
    let wrong = source(
        "w",
        &[(
            "w.ino",
            "#if 0\nvoid no() {\n#endif\nvoid setup() { oops(); }\nvoid loop() {}\n",
        )],
    );
    let said = refused(&compiler, &wrong);
    assert!(said.starts_with("w.ino:4:21: error: 'oops'"), "{said}");
    let missing = source(
        "m",
        &[(
            "m.ino",
            "#include <Nowhere.h>\nvoid setup() {}\nvoid loop() {}\n",
        )],
    );
    let said = refused(&compiler, &missing);
    assert!(
        said.contains("m.ino:1:") && said.contains("by --libraries"),
        "{said}"
    );
}

#[test]
fn libraries_are_taken_by_their_headers_from_beside_the_sketch_and_from_folders() {
    let Ok(toolchain) = Toolchain::find() else {
        return;
    };
    let folders = tempfile::tempdir().unwrap();
    for (file, text) in [
        ("Steering/SteerControl.h", "int steer(int x);\n"),
        (
            "Steering/SteerControl.cpp",
            "#include \"SteerControl.h\"\nint steer(int x) { int unused; return x; }\n",
        ),
        ("Horn/library.properties", "name=Horn\narchitectures=avr\n"),
        ("Horn/src/Horn.h", "struct Horn { void blow(int); };\n"),
        (
            "Horn/src/avr/Horn.cpp",
            "#include \"../Horn.h\"\n#include <Arduino.h>\nvoid Horn::blow(int n) { delay(n); }\n",
        ),
    ] {
        let path = folders.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let main = "#include <arduino.h>\n#include <horn.h>\n#include \"pins.h\"\n# include <SteerControl.h>\n#include <Lamp.hpp>\nHorn horn;\n\
                void setup() { horn.blow(steer(lamp())); }\nvoid loop() {}\n";
    let lamp = [
        ("libraries/Lamp/src/Lamp.hpp", "int lamp();\n"),
        (
            "libraries/Lamp/src/deep/lamp.cpp",
            "#include \"../Lamp.hpp\"\nint lamp() { int unused; return 2; }\n",
        ),
    ];
    let cache = tempfile::tempdir().unwrap();
    let sandbox = Sandbox::trusting(Limits::default());
    let toolchain = toolchain.with_libraries(&[folders.path().to_owned()]);
    let compiler = Compiler::new(BOARDS[0], toolchain, sandbox, cache.path().to_owned()).unwrap();
    // As on Windows and macOS, a header is found whatever its capitals are, also beside a file in a folder.
    let files = [
        &[
            ("honk.ino", main),
            ("Pins.h", "#define HORN 3\n"),
            (
                "src/car/wheels.cpp",
                "#include \"Wheels.h\"\n#include \"../Axle/axle.h\"\nint wheels() { return AXLES; }\n",
            ),
            ("src/car/wheels.h", "int wheels();\n"),
            ("src/axle/Axle.h", "#define AXLES 2\n"),
        ][..],
        &lamp,
    ]
    .concat();
    // A library's warnings are nobody's here.
    assert_eq!(
        compiler
            .compile(&source("honk", &files), &[])
            .unwrap()
            .warnings,
        []
    );
    // The same as PlatformIO has it.
    let platformio = format!("#include <Arduino.h>\n#include \"pins.h\"\n{main}");
    let files = [
        ("src/main.cpp", platformio.as_str()),
        ("include/pins.h", "#define LED 13\n"),
        ("src/car/Wheels.h", "#include \"../axle.h\"\n"),
        ("src/Axle.h", "#define AXLES 2\n"),
        (
            "src/car/wheels.cpp",
            "#include \"wheels.h\"\nint wheels() { return AXLES; }\n",
        ),
        ("lib/Lamp/Lamp.hpp", "int lamp();\n"),
        (
            "lib/Lamp/lamp.cpp",
            "#include \"Lamp.hpp\"\nint lamp() { return 2; }\n",
        ),
    ];
    compiler.compile(&source("honk", &files), &[]).unwrap();
}

#[test]
fn what_a_project_says_in_its_build_flags_reaches_its_program() {
    let Some((compiler, _cache)) = compiler() else {
        return;
    };
    let main = "#include <Arduino.h>\nextern \"C\" int speed(void);\nauto half = [](auto x) { return x / 2; };\n\
                void setup() { half(speed()); }\nvoid loop() { }\n";
    let files = |said: &str| {
        let project = format!("[env:mega]\nplatform = atmelavr\nbuild_flags = {said}\n");
        let files = [
            ("platformio.ini", &project[..]),
            ("src/main.cpp", main),
            ("src/speed.c", "int speed(void) { return SPEED; }\n"),
        ];
        source("flags", &files)
    };
    let image = compiler.compile(&files("-std=gnu++14\n  -D SPEED=7"), &[]);
    assert_eq!(image.unwrap().warnings, []);
    // Files for another board, and a library that includes what the flags lead to.
    let mut boards = files(
        "-Iinclude/ -DSPEED=7 -std=gnu++14\nbuild_src_filter = -<*> +<main.cpp> +<*.c> +<lamp/>",
    );
    for (name, text) in [
        ("src/esp.cpp", "#include <Update.h>\n"),
        (
            "src/lamp/on.cpp",
            "#include \"Lamp.h\"\nint on() { return lamp(); }\n",
        ),
        ("lib/My Lamp/Lamp.h", "#include \"pins.h\"\nint lamp();\n"),
        (
            "lib/My Lamp/Lamp.cpp",
            "#include \"Lamp.h\"\nint lamp() { return LAMP; }\n",
        ),
        ("include/pins.h", "#define LAMP 13\n"),
    ] {
        boards.files.insert(name.into(), text.into());
    }
    compiler.compile(&boards, &[]).unwrap();
    let without = refused(&compiler, &files("-D OTHER"));
    assert!(
        without.contains("SPEED") && without.contains("'auto'"),
        "{without}"
    );
    if compiler.toolchain().compiler.starts_with("5.") {
        let mut new = files("-std=gnu++17 -DSPEED=7");
        let newer = "template <class... T> int sum(T... all) { return (all + ...); }\n";
        new.files.insert("src/new.cpp".into(), newer.into());
        let hint = refused(&compiler, &new);
        assert!(
            hint.contains("-std=gnu++17 is more than avr-gcc 5."),
            "{hint}"
        );
    }
}
