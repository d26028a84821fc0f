// @ts-check
/** *Your robot*, in Spanish. */

/** @type {Record<string, string>} */
export const WIRING = {
  'Your robot': 'Tu robot', 'A robot of your own: its board, driver and pins, driven by your sketch': 'Un robot tuyo: su placa, su controlador de motores y sus pines, conducido por tu sketch',
  'Say where its wires go, by number or as A0; or drag a name onto the board. Then choose the sketch that drives it.':
    'Di adónde van sus cables, con un número o como A0, o arrastra un nombre a la placa. Después elige el sketch que lo conduce.',
  'begin with': 'empezar por', 'my own wiring': 'mi propio cableado', board: 'placa', 'motor driver': 'controlador de motores', 'four wheels': 'cuatro ruedas', 'battery [V]': 'batería [V]', add: 'añadir',
  '{}, enables on jumpers': '{}, habilitaciones con puentes', Remove: 'Quitar', 'Remove {}': 'Quitar {}',
  'Sketch folder…': 'Carpeta del sketch…', 'Files…': 'Archivos…', 'Drive it': 'Conducirlo', 'The robot file': 'El archivo del robot',
  'Choose its sketch first': 'Elige primero su sketch', 'Pins of the {}; ~ has PWM': 'Pines de la placa {}; ~ tiene PWM',
  'still without a pin: {}': 'aún sin pin: {}', '{}: the {} has no pin {}': '{}: la placa {} no tiene el pin {}',
  '{} of {} pins are those of {}': '{} de {} pines son los de {}', '{} is {} there': '{} es allí {}',
  'no sketch there: a folder with an .ino': 'ahí no hay ningún sketch: una carpeta con un .ino',
  '{} files: a sketch has at most {}; choose its own folder': '{} archivos: un sketch tiene como mucho {}; elige su propia carpeta',
  'left|wiring': 'izquierda', 'right|wiring': 'derecha', 'front|wiring': 'delante', Bluetooth: 'Bluetooth',
  'rear|wiring': 'detrás', 'fault, low': 'fallo, nivel bajo', enable: 'habilitación', 'forward input': 'entrada de avance', 'backward input': 'entrada de retroceso', encoder: 'encoder', 'encoder, output B': 'encoder, salida B',
  'sonar, Trig': 'sónar, Trig', 'sonar, Echo': 'sónar, Echo', 'the board receives': 'la placa recibe', 'the board sends': 'la placa envía',
  standby: 'standby', 'line sensor': 'sensor de línea', 'obstacle sensor': 'sensor de obstáculos', Sharp: 'Sharp', 'light sensor': 'sensor de luz', MaxSonar: 'MaxSonar',
  button: 'pulsador', 'switch|part': 'interruptor', potentiometer: 'potenciómetro', LED: 'LED', buzzer: 'zumbador', 'infrared receiver': 'receptor de infrarrojos',
  'MPU-6050': 'MPU-6050', 'display SSD1306': 'pantalla SSD1306', 'display HD44780': 'pantalla HD44780',
};
