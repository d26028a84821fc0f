use super::*;

fn op(word: u16) -> Op {
    decode(0x100, word, 0x0000)
}

#[test]
fn words_are_what_the_assembler_made_of_them() {
    for (word, expected) in [
        (0x0000, Op::new(Code::Nop, 0, 0)),
        (0x01FE, Op::new(Code::Movw, 30, 28)),
        (0x0F00, Op::new(Code::Add, 16, 16)),
        (0x0FFF, Op::new(Code::Add, 31, 31)),
        (0xE0F2, Op::new(Code::Ldi, 31, 2)),
        (0x9631, Op::new(Code::Adiw, 30, 1)),
        (0xBFCD, Op::new(Code::Out, 28, 0x3D)),
        (0xB6CE, Op::new(Code::In, 12, 0x3E)),
        (0x9A2D, Op::new(Code::Sbi, 5, 0x20)),
        (0x8189, Op::new(Code::LddY, 24, 1)),
        (0xAFFF, Op::new(Code::StdY, 31, 63)),
        (0x9508, Op::new(Code::Ret, 0, 0)),
        (0x94F8, Op::new(Code::Bclr, 7, 0)),
        (0x9478, Op::new(Code::Bset, 7, 0)),
        (0xCFFF, Op::target(Code::Rjmp, 0x100)),
        (0xF7F1, Op::target(Code::Brne, 0xFF)),
        (0xF40C, Op::new(Code::Brbc, 4, 2)),
        (0x9FF0, Op::new(Code::Mul, 31, 16)),
        (0x0301, Op::new(Code::Mulsu, 16, 17)),
    ] {
        assert_eq!(op(word), expected, "{word:04x}");
    }
}

#[test]
fn far_jumps_take_a_second_word_and_skips_know_it() {
    assert_eq!(decode(0, 0x940C, 0x1234).address(), 0x1234);
    assert_eq!(decode(0, 0x940D, 0x0001).address(), 0x1_0001);
    assert_eq!(decode(0, 0x940E, 0x0001).code, Code::Call);
    for (next, words) in [
        (0x0000, 0x200),
        (0x940E, 0x300),
        (0x9000, 0x300),
        (0x9200, 0x300),
    ] {
        assert_eq!(
            decode(0, 0xFC07, next),
            Op::new(Code::Sbrc, 0, 0x80 | words)
        );
    }
    assert!(!is_long(0x9001) && !is_long(0x9409));
}

#[test]
fn every_word_decodes_and_only_the_gaps_of_the_map_are_illegal() {
    let illegal = (0..=u16::MAX)
        .filter(|word| matches!(op(*word).code, Code::Illegal | Code::Erased))
        .count();
    // 255 between NOP and MOVW; 5 x 32 and 7 x 32 of the loads and stores; 1001 010x xxxx 0100 and 1011;
    // bits and commands of 1001 010x xxxx 1000 and 1001; 1111 1xxx xxxx 1xxx.
    let loads = 3 * 32 + 7 * 32;
    let ones = 2 * 32;
    let alone = (32 - 16 - 8) + (32 - 4);
    assert_eq!(illegal, 255 + loads + ones + alone + 1024);
}
