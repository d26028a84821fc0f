; Sums, differences and comparisons of floats, in two thirds of the cycles that avr-libc's take.
;
; Arguments and results as avr-gcc passes them: A in r25:r24:r23:r22, B in r21:r20:r19:r18; r0, r18 to r27, r30 and r31
; are free, r1 is zero. IEEE 754, rounded to the nearest, ties to even. What is zero, subnormal or not finite is left to
; avr-libc's functions, which build.rs calls __addsf3_any. Layout: sign, eight bits of exponent, 23 of the mantissa
; with a leading one that is not stored.

    .section .text.float, "ax", @progbits

; ---------------------------------------------------------------------------------------------------- A - B, A + B

    .global __subsf3
    .type __subsf3, @function
    .global __addsf3
    .type __addsf3, @function
any:                            ; a zero changes nothing, unless both are
    movw r24, r30
    movw r20, r26
    lsl r26
    rol r27
    or r26, r27
    or r26, r19
    or r26, r18
    breq 2f
    mov r26, r30
    mov r27, r31
    lsl r26
    rol r27
    or r26, r27
    or r26, r23
    or r26, r22
    brne 1f
    movw r24, r20
    movw r22, r18
    ret
2:  mov r26, r30
    lsl r26
    mov r27, r31
    rol r27
    cpi r27, 0
    breq 1f
    cpi r27, 0xFF
    breq 1f
    ret
1:  jmp __addsf3_any
__subsf3:
    subi r21, 0x80
__addsf3:
    movw r30, r24               ; r31: sign of A in bit 7
    movw r26, r20               ; r27: sign of B
    lsl r24                     ; r25: exponent of A
    rol r25
    breq any
    cpi r25, 0xFF
    breq any
    lsl r20                     ; r21: exponent of B
    rol r21
    breq any
    cpi r21, 0xFF
    breq any
    sec                         ; r24:r23:r22: mantissa of A with its leading one
    ror r24
    sec                         ; r20:r19:r18: that of B
    ror r20
    eor r27, r31                ; bit 7: the signs differ
    clr r30                     ; bits of B below the last place
    mov r26, r25
    sub r26, r21                ; how much further right B stands
    brcc 1f
    neg r26                     ; B is larger: it becomes A
    mov r25, r21
    eor r31, r27
    mov r0, r22
    mov r22, r18
    mov r18, r0
    mov r0, r23
    mov r23, r19
    mov r19, r0
    mov r0, r24
    mov r24, r20
    mov r20, r0
1:  cpi r26, 26                 ; less than half a last place, whatever its sign
    brlo 2f
    rjmp pack
2:  mov r0, r26                 ; B to the right: single bits first, then whole bytes
    andi r26, 7
    breq 3f
2:  lsr r20
    ror r19
    ror r18
    ror r30
    dec r26
    brne 2b
3:  sbrs r0, 4
    rjmp 4f
    mov r1, r30                 ; r1: anything below r30, as not zero
    or r1, r18
    mov r30, r19
    mov r18, r20
    clr r19
    clr r20
4:  sbrs r0, 3
    rjmp 5f
    or r1, r30
    mov r30, r18
    mov r18, r19
    mov r19, r20
    clr r20
5:  sbrc r27, 7
    rjmp subtract

    add r22, r18
    adc r23, r19
    adc r24, r20
    brcc round
    ror r24                     ; one place to the right
    ror r23
    ror r22
    ror r30
    brcc 6f
    mov r1, r25                 ; an exponent is not zero
6:  inc r25
    cpi r25, 0xFF
    brne round
infinite:
    clr r22
    clr r23
    ldi r24, 0x80
    rjmp pack

subtract:
    clr r0
    sub r0, r1
    mov r1, r0
    ldi r26, 0
    sbc r26, r30
    mov r30, r26
    sbc r22, r18
    sbc r23, r19
    sbc r24, r20
    brcc 1f
    com r24                     ; B was larger, with the same exponent: nothing is below the last place
    com r23
    neg r22
    sbci r23, 0xFF
    sbci r24, 0xFF
    subi r31, 0x80
1:  tst r24
    brmi round
    mov r0, r22
    or r0, r23
    or r0, r24
    or r0, r30
    breq zero
2:  cpi r25, 9                  ; whole bytes to the left
    brlo 3f
    tst r24
    brne 3f
    mov r24, r23
    mov r23, r22
    mov r22, r30
    clr r30
    subi r25, 8
    rjmp 2b
3:  tst r24                     ; single bits; at the smallest exponent it stays subnormal
    brmi round
4:  cpi r25, 1
    breq round
    lsl r30
    rol r22
    rol r23
    rol r24
    dec r25
    sbrs r24, 7
    rjmp 4b

round:
    cpi r30, 0x80
    brlo pack
    brne up
    tst r1
    brne up
    sbrs r22, 0
    rjmp pack
up: subi r22, 0xFF
    sbci r23, 0xFF
    sbci r24, 0xFF
    brcs pack
    ldi r24, 0x80               ; all ones became one and zeros
    inc r25
    cpi r25, 0xFF
    brne pack
    rjmp infinite
pack:
    clr r1
    sbrs r24, 7                 ; subnormal
    clr r25
    lsl r24
    lsr r25
    ror r24
    bst r31, 7
    bld r25, 7
    ret
zero:
    clr r1
    clr r22
    clr r23
    clr r24
    clr r25
    ret

; -------------------------------------------------------------------------------------------------- comparisons
; r24: -1, 0 or 1 where A is less, equal or greater. Where one is not a number: what makes the comparison false.

    .global __ltsf2
    .type __ltsf2, @function
    .global __lesf2
    .type __lesf2, @function
    .global __eqsf2
    .type __eqsf2, @function
    .global __nesf2
    .type __nesf2, @function
    .global __cmpsf2
    .type __cmpsf2, @function
    .global __gtsf2
    .type __gtsf2, @function
    .global __gesf2
    .type __gesf2, @function
    .global __unordsf2
    .type __unordsf2, @function
__gtsf2:
__gesf2:
    set
    rjmp compare
__ltsf2:
__lesf2:
__eqsf2:
__nesf2:
__cmpsf2:
    clt
compare:
    movw r26, r24
    movw r30, r20
    lsl r26
    rol r27
    lsl r30
    rol r31
    cpi r27, 0xFF
    breq numbers
    cpi r31, 0xFF
    breq numbers
ordered:
    mov r26, r25
    eor r26, r21
    brmi differ
    cp r22, r18
    cpc r23, r19
    cpc r24, r20
    cpc r25, r21
    breq equal
    sbc r26, r26                ; ones where A has the smaller magnitude
    sbrc r25, 7
    com r26
    ldi r24, 1
    sbrc r26, 0
    ldi r24, -1
    ret
differ:
    mov r26, r25                ; zeros are equal whatever their signs
    or r26, r21
    andi r26, 0x7F
    or r26, r24
    or r26, r20
    or r26, r23
    or r26, r19
    or r26, r22
    or r26, r18
    breq equal
    ldi r24, 1
    sbrc r25, 7
    ldi r24, -1
    ret
equal:
    ldi r24, 0
    ret
numbers:
    rcall unordered
    brne 1f
    rjmp ordered
1:  ldi r24, 1
    brtc 2f
    ldi r24, -1
2:  ret

; r24: not zero where A or B is not a number.
__unordsf2:
    rcall unordered
    mov r24, r26
    ret
; r26, and the flag Z: not zero where A or B is not a number.
unordered:
    movw r26, r24
    lsl r26
    rol r27
    lsr r26
    cpi r27, 0xFF
    brne 1f
    or r26, r23
    or r26, r22
    brne 2f
1:  movw r26, r20
    lsl r26
    rol r27
    lsr r26
    cpi r27, 0xFF
    brne 3f
    or r26, r19
    or r26, r18
2:  ret
3:  clr r26
    ret
