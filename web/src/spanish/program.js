// @ts-check
/** What is said of a program at the pins of an emulated robot, in Spanish: how it ended, what is odd about it, the debugger. */

/** @type {Record<string, string>} */
export const PROGRAM = {
  // How it ended.
  'ran into erased flash at {} in cycle {}, {}': 'llegó a memoria flash borrada en {}, en el ciclo {}, {}',
  'illegal instruction 0x{} at {} in cycle {}, {}; or this image is for another chip': 'instrucción no válida 0x{} en {}, en el ciclo {}, {}; o esta imagen es para otro chip',
  'stack overflow at {} in cycle {}: {} bytes deep, down to 0x{}, the data end at 0x{}{}': 'desbordamiento de pila en {}, en el ciclo {}: {} bytes de profundidad, hasta 0x{}; los datos acaban en 0x{}{}',
  '; {} is on it {} times': '; {} está en ella {} veces', '; called from {}': '; llamado desde {}', ', from ': ', desde ',
  'by the return at {} with the stack pointer at 0x{}: the return address was overwritten, or the stack is out of step': 'por el retorno en {} con el puntero de pila en 0x{}: se sobrescribió la dirección de retorno, o la pila está descuadrada',
  'by {} at {}: a wrong function pointer': 'por {} en {}: un puntero a función erróneo',
  'by interrupt {}: the program has no table of vectors there': 'por la interrupción {}: el programa no tiene ahí una tabla de vectores',
  'by the jump at {}: the image lacks what it leads to': 'por el salto en {}: a la imagen le falta aquello a lo que lleva',
  'after the instruction at {}: the program goes on past its end, or into its constants': 'tras la instrucción en {}: el programa sigue más allá de su final, o entra en sus constantes',
  'where a program begins: the image has nothing there': 'donde empieza un programa: la imagen no tiene nada ahí',
  'by a jump through a wrong pointer, or a return address overwritten': 'por un salto con un puntero erróneo, o una dirección de retorno sobrescrita',
  'firmware {}: it sleeps with interrupts off, before {}: nothing wakes it; call sei() before sleep_cpu()': 'firmware {}: duerme con las interrupciones desactivadas, antes de {}: nada lo despierta; llama a sei() antes de sleep_cpu()',
  'firmware {}: it has ended at {}: main() returned, or exit() was called, or it stops itself with cli() and an empty loop; main() needs a loop that never ends': 'firmware {}: ha terminado en {}: main() volvió, se llamó a exit(), o se detiene él mismo con cli() y un `for (;;)` vacío; main() no debe acabar nunca',
  'firmware {}: it stands in a loop of one instruction at {} with interrupts off: only a reset leads on': 'firmware {}: repite para siempre una instrucción en {} con las interrupciones desactivadas: solo un reset lo saca de ahí',
  'firmware {}: it restarted {} times without a reset, the last time from {}: {}': 'firmware {}: se reinició {} veces sin un reset, la última desde {}: {}',
  'an interrupt was on that no function handles': 'había activada una interrupción que ninguna función atiende',
  'a function that is not there was called, or a pointer to one that is 0; with Arduino\'s core 1.8.3 and later `new` is not there where <new> or <new.h> is included: leave that line out': 'se llamó a una función que no está, o a un puntero que vale 0; con el core 1.8.3 de Arduino y posteriores `new` no está donde se incluye <new> o <new.h>: quita esa línea',
  // What is odd about it.
  'firmware {}: register 0x{}, {} at {}, is not modelled': 'firmware {}: el registro 0x{} ({}, en {}) no está modelado', 'read': 'leído',
  'firmware {}: a trigger of a sonar was high for {} us; the HC-SR04\'s data sheet asks for 10 us, and some modules do not answer a shorter one': 'firmware {}: un disparo de un sonar estuvo alto {} µs; la hoja de datos del HC-SR04 pide 10 µs, y algunos módulos no responden a uno más corto',
  'firmware {}: the supply fell too low and reset the chip {} times; start the motors more gently, or charge the battery': 'firmware {}: la alimentación cayó demasiado y reinició el chip {} veces; arranca los motores con más suavidad, o carga la batería',
  'firmware {}: the watchdog reset the chip {} times; call wdt_reset() in time, or wdt_disable() at the start of setup()': 'firmware {}: el watchdog reinició el chip {} veces; llama a tiempo a wdt_reset(), o a wdt_disable() al empezar setup()',
  'firmware {}: it sends over the Bluetooth link at {} baud; the module is set to {}, and what it passes on is garbage: give begin() that rate': 'firmware {}: envía por el enlace Bluetooth a {} baudios; el módulo está a {}, y lo que transmite es basura: da esa velocidad a begin()',
  'firmware {}: what it sends to the Bluetooth module is not at {} baud, and what that passes on is garbage: give begin() that rate, or the wiring link_baud': 'firmware {}: lo que envía al módulo Bluetooth no va a {} baudios, y lo que este transmite es basura: da esa velocidad a begin(), o link_baud al cableado',
  'firmware {}: UDR{} was written at {} while the transmitter of {} was off: nothing was sent; set TXEN{} in UCSR{}B, or call begin()': 'firmware {}: se escribió UDR{} en {} con el transmisor de {} apagado: no se envió nada; pon TXEN{} en UCSR{}B, o llama a begin()',
  'firmware {}: it never drove a motor; are its pins those of wiring {}? (docs/emulator.md)': 'firmware {}: nunca accionó un motor; ¿son sus pines los del cableado {}? (docs/emulator.md)',
  'firmware {}: nothing came over the Bluetooth link, {} in wiring {}, {}': 'firmware {}: no llegó nada por el enlace Bluetooth, {} en el cableado {}, {}',
  'on no other either': 'ni por ningún otro', 'but on {}': 'pero sí por {}', 'its pins': 'sus pines',
  'firmware {}: it never drove the {} motor: {}': 'firmware {}: nunca accionó el motor {}: {}', 
  'firmware {}: it drove the wheels against each other all the time; if it was to drive straight, exchange forward and backward of the wheel that turns the wrong way, in the wiring {} or at the motor': 'firmware {}: hizo girar las ruedas en sentidos opuestos todo el tiempo; si debía ir recto, intercambia adelante y atrás de la rueda que gira al revés, en el cableado {} o en el motor',
  '{} (pin {})': '{} (pin {})', '{} of M{}': '{} de M{}', '{} was never high, and the driver slept': '{} nunca estuvo alto, y el driver dormía',
  ', unless a jumper holds it: then write "high" in the wiring': ', salvo que lo sujete un puente: entonces escribe "high" en el cableado', '{} was never high{}': '{} nunca estuvo alto{}',
  '{} and {} were never high': '{} y {} nunca estuvieron altos', '{} and {} never differed while it was enabled': '{} y {} nunca fueron distintos mientras estuvo habilitado',
  '{} is on pin {}, which has no PWM on the {}: analogWrite() there only switches; PWM is on {}': '{} está en el pin {}, que no tiene PWM en el {}: analogWrite() ahí solo conmuta; hay PWM en {}',
  'firmware {}: {} on pin {} closes to GND, and the program switches no pull-up on, so that open and closed read alike: use INPUT_PULLUP, or say what resistor there is, to = "5v" where pressed is HIGH, else to = "gnd"': 'firmware {}: {}, en el pin {}, cierra a GND y el programa no activa ningún pull-up, así que abierto y cerrado se leen igual: usa INPUT_PULLUP, o di qué resistencia hay, to = "5v" si pulsado es HIGH, si no to = "gnd"',
  // What of the robot was not identified.
  'motor driver: {}': 'driver de motores: {}', '{}, by {}, not identified': '{}, según {}, sin identificar', 'driver with a direction and a PWM input': 'driver con una entrada de dirección y una de PWM',
  'motor shield with L293D and 74HC595': 'shield de motores con L293D y 74HC595', 'motor shield with TB6612FNG and PCA9685': 'shield de motores con TB6612FNG y PCA9685',
  'its data sheet (TI SLRS008)': 'su hoja de datos (TI SLRS008)', 'its data sheet (TI SLVSAR1)': 'su hoja de datos (TI SLVSAR1)', 'its data sheet (Toshiba TB6612FNG, 2014-10-01)': 'su hoja de datos (Toshiba TB6612FNG, 2014-10-01)',
  'the data sheet of the L293D (TI SLRS008)': 'la hoja de datos del L293D (TI SLRS008)', 'the data sheet of the TB6612FNG': 'la hoja de datos del TB6612FNG',
  'line sensors: TCRT5000 modules by their data sheet, not identified': 'sensores de línea: módulos TCRT5000 según su hoja de datos, sin identificar',
  'line sensors: QTR-RC by what Pololu says of it, not identified': 'sensores de línea: QTR-RC según lo que dice Pololu, sin identificar',
  'accelerometer and gyroscope: MPU-6050 by its data sheet, not identified': 'acelerómetro y giróscopo: MPU-6050 según su hoja de datos, sin identificar',
  'sensors for obstacles: by what their sellers and Sharp\'s data sheet say, not identified': 'sensores de obstáculos: según sus vendedores y la hoja de datos de Sharp, sin identificar',
  'two BTS7960 a motor (IBT-2)': 'dos BTS7960 por motor (IBT-2)', 'its data sheet (Infineon, 2004-12-07)': 'su hoja de datos (Infineon, 2004-12-07)',
  'its data sheet (ASIC L9110)': 'su hoja de datos (ASIC L9110)', 'the data sheet of the TC1508S': 'la hoja de datos del TC1508S',
  // The debugger.
  'the program stands at {}, and time with it': 'el programa está parado en {}, y el tiempo con él', 'the program goes on': 'el programa sigue', 'a debugger has come': 'ha entrado un depurador',
  'the debugger has left; the program goes on': 'el depurador se ha ido; el programa sigue', 'the debugger is gone with the run': 'el depurador se fue con la ejecución',
  // The link's speed.
  '{} baud carry {} bytes/s, too few for the heartbeats ({} bytes/s) and answers that keep the robot going; it needs at least {}, its own speed is {}': '{} baudios llevan {} bytes/s, demasiado pocos para los latidos ({} bytes/s) y las respuestas que mantienen en marcha el robot; necesita al menos {}, su propia velocidad es {}',
  '{} baud carry {} bytes/s, full telemetry needs {}: expect {} Hz at most, not {}': '{} baudios llevan {} bytes/s, la telemetría completa necesita {}: espera {} Hz como mucho, no {}',
};
