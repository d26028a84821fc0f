// @ts-check
/** Spanish of the page's own texts. */

/** @type {Record<string, string>} */
export const PAGE = {
  // The top line.
  'scenario': 'escenario', 'world': 'mundo', 'rig': 'montaje', 'seed': 'semilla', 'speed': 'velocidad', 'Reset': 'Reiniciar',
  'Start the simulation again with this scenario, world, rig and seed': 'Empieza la simulación de nuevo con este escenario, mundo, montaje y semilla',
  'its own': 'el suyo', '{} (own)': '{} (el suyo)', 'paused': 'en pausa',
  'round trip': 'ida y vuelta', 'errors': 'errores', 'link': 'enlace', 'battery': 'batería',
  'From a command to its acknowledgement': 'Desde una orden hasta su confirmación',
  'Frames that failed the check (CRC), from and to the robot': 'Tramas que no pasaron la comprobación (CRC), desde y hacia el robot',
  'Share of the link\'s capacity in use, from and to the robot': 'Parte en uso de la capacidad del enlace, desde y hacia el robot',
  'Battery, as the robot measures it': 'Batería, medida por el robot',
  'Battery of the simulation; the robot has nothing wired to measure it': 'Batería de la simulación; el robot no tiene con qué medirla',
  'STOP': 'PARAR', 'Space': 'Espacio',
  'Release the wheels at once (Space, from anywhere but a line of text)': 'Suelta las ruedas al instante (Espacio, desde cualquier sitio salvo una línea de texto)',
  'you watch; STOP works': 'miras; PARAR funciona', 'another page has control; STOP works': 'otra página tiene el control; PARAR funciona',
  'Take control': 'Tomar el control', 'Drive from this page; the other one then watches': 'Conduce desde esta página; la otra pasa a mirar',
  'connecting…': 'conectando…', 'no connection, trying again…': 'sin conexión, reintentando…', 'no connection: {}, trying again…': 'sin conexión: {}, reintentando…',
  'replay, paused': 'grabación, en pausa', 'replay × {}': 'grabación × {}', 'simulation paused': 'simulación en pausa',
  'the station is silent': 'la estación no dice nada', 'no answer from the robot': 'el robot no responde', 'live {} Hz': 'en vivo {} Hz', '{}, only × {}': '{}, solo × {}',
  '{}: not sent, there is no connection': '{}: no enviado, no hay conexión',
  'Language': 'Idioma',
  // Replay.
  'Replay': 'Grabación', 'The log that is shown': 'La grabación que se muestra', 'Play': 'Reproducir', 'Pause': 'Pausa',
  'Play or pause (K)': 'Reproducir o pausar (K)', 'One telemetry frame back (comma)': 'Una trama de telemetría atrás (coma)', 'One frame back': 'Una trama atrás',
  'One telemetry frame on (full stop)': 'Una trama de telemetría adelante (punto)', 'One frame on': 'Una trama adelante',
  'Time in the log': 'Tiempo en la grabación', 'Speed of the replay': 'Velocidad de la reproducción', '{} of {} s': '{} de {} s',
  // Map and state line.
  'Map': 'Mapa',
  'Map of the world and the robot. Drag to move, wheel or + and - to zoom, 0 to fit; in modes 7 and 8 a click picks a place':
    'Mapa del mundo y del robot. Arrastrar lo mueve, la rueda o + y - lo amplían, 0 lo ajusta; en los modos 7 y 8 un clic elige un lugar',
  'as it is': 'como es', 'as it estimates': 'como lo estima', 'Fit': 'Ajustar', 'Show everything (0 on the map)': 'Muestra todo (0 en el mapa)',
  'Tell it': 'Decírselo', 'Write the rig that it carries to the robot': 'Escribe en el robot el montaje que lleva',
  'The robot believes to carry the rig {}, and carries {}: it misreads its sonars.': 'El robot cree llevar el montaje {} y lleva {}: interpreta mal sus sonares.',
  'heading': 'rumbo', 'goal': 'destino', 'to': 'hacia', ', {} m away': ', a {} m', 'references': 'consignas', 'contact!': '¡contacto!',
  'follows the lane': 'sigue el carril', 'route of {}': 'ruta de {}', 'route of {}, again and again': 'ruta de {}, una y otra vez',
  'no reading': 'sin lectura', 'clear|sonar': 'libre', 'Clear fault': 'Borrar fallo',
  // Commands.
  'Commands': 'Órdenes', 'Mode': 'Modo', 'Arm and start the mode': 'Arma el robot y empieza el modo', 'Stop the mode and disarm': 'Detiene el modo y desarma',
  'Switch OFF first': 'Primero OFF', 'reference': 'consigna', 'Set': 'Fijar', 'now {} cm': 'ahora {} cm', 'now {} rpm': 'ahora {} rpm', '{} to {} {}': 'de {} a {} {}',
  'left': 'izq.', 'right': 'der.', 'front': 'frontal', 'both': 'ambas',
  'Open loop by PWM, or closed loop by speed': 'Lazo abierto por PWM, o lazo cerrado por velocidad', 'pivot on': 'pivote', 'level': 'nivel',
  'Armed, the arrow keys drive while they are held.': 'Armado, las flechas lo mueven mientras se pulsan.',
  'arc left': 'arco a la izquierda', 'forward': 'adelante', 'arc right': 'arco a la derecha', 'turn left about the centre': 'giro a la izquierda sobre el centro',
  'release both wheels': 'suelta las dos ruedas', 'turn right about the centre': 'giro a la derecha sobre el centro',
  'arc backward, centre on the left': 'arco atrás, centro a la izquierda', 'backward': 'atrás', 'arc backward, centre on the right': 'arco atrás, centro a la derecha',
  'pivot on the left wheel, forward': 'pivote en la rueda izquierda, adelante', 'pivot on the left wheel, backward': 'pivote en la rueda izquierda, atrás',
  'pivot on the right wheel, forward': 'pivote en la rueda derecha, adelante', 'pivot on the right wheel, backward': 'pivote en la rueda derecha, atrás',
  'Set route': 'Fijar ruta', 'goal x': 'destino x', 'Set goal': 'Fijar destino', 'Set this goal': 'Fija este destino', 'LANE': 'CARRIL', 'Follow a lane of boxes': 'Sigue un carril de cajas',
  'goal, x: forward of the robot\'s origin, in m': 'destino, x: por delante del origen del robot, en m',
  'goal, y: left of the robot\'s origin, in m': 'destino, y: a la izquierda del origen del robot, en m',
  'A click on the map sets the goal: x forward, y left of the robot\'s origin.': 'Un clic en el mapa fija el destino: x adelante, y a la izquierda del origen del robot.',
  'Scenario\'s': 'Del escenario', 'Scenario\'s {}': 'Del escenario, {}', 'Take the scenario\'s route': 'Toma la ruta del escenario',
  'Square 1 m': 'Cuadrado 1 m', 'Take the square of the report': 'Toma el cuadrado de la memoria', 'Begin anew': 'Empieza de nuevo',
  'Starts over at the end': 'Vuelve a empezar al final', 'repeat': 'repetir', 'relative': 'relativa',
  'As seen from where the robot starts, not from its origin': 'Vista desde donde arranca el robot, no desde su origen',
  'Clicks on the map add places, {} at most.': 'Los clics en el mapa añaden lugares, {} como máximo.', 'Take this place out': 'Quita este lugar',
  // Plots.
  'Plots': 'Gráficas', 'Pause view': 'Pausar vista', 'Live': 'En vivo', 'Clear': 'Borrar', 'window': 'ventana',
  'Hold the view; data goes on arriving (P)': 'Detiene la vista; los datos siguen llegando (P)',
  'Follow the newest data (L, or double click in a plot)': 'Sigue los datos más nuevos (L, o doble clic en una gráfica)', 'Forget what is plotted so far': 'Olvida lo dibujado hasta ahora',
  'Plots shown': 'Gráficas mostradas', 'Drag to zoom, wheel to zoom in time, double click to follow': 'Arrastrar amplía, la rueda amplía en el tiempo, doble clic sigue en vivo',
  'Plot {}, or not': 'Dibuja {}, o no', '{}: show or hide': '{}: mostrar u ocultar', 'state': 'estado',
  'distance': 'distancia', 'wheels': 'ruedas', 'place': 'posición', 'of 255': 'de 255',
  'true l.': 'real izq.', 'true r.': 'real der.', 'true front': 'real frontal', 'ref. l.': 'ref. izq.', 'ref. r.': 'ref. der.', 'true': 'real',
  'true x': 'x real', 'true y': 'y real', 'goal y': 'destino y',
  // Consoles, parameters, events.
  'Consoles': 'Consolas', 'what the emulated chip sends': 'lo que envía el chip emulado', 'Text of the USART': 'Texto de la USART', 'Line to send': 'Línea que enviar', 'Send': 'Enviar',
  'Send the line, ended by LF, to this USART': 'Envía la línea, acabada en LF, a esta USART',
  'Parameters': 'Parámetros', 'all modes': 'todos los modos', 'Defaults': 'De fábrica', 'Set every parameter to its default': 'Pone cada parámetro en su valor de fábrica',
  'name': 'nombre', 'value': 'valor', 'unit': 'unidad', 'range': 'margen', 'default': 'de fábrica', '{} in {}': '{} en {}', 'no unit': 'sin unidad',
  'Apply': 'Aplicar', 'Write to the robot (Enter)': 'Escribe en el robot (Intro)', 'Back to what the robot holds (Escape)': 'Vuelve a lo que tiene el robot (Escape)', 'Revert': 'Deshacer',
  'waiting…': 'esperando…', 'refused: {}': 'rechazado: {}', 'not read yet': 'aún sin leer', 'the robot has another table: not shown': 'el robot tiene otra tabla: no se muestra',
  'Events': 'Sucesos', 'newest first': 'los últimos primero', 'Events, newest first': 'Sucesos, los últimos primero',
  'info': 'información', 'good': 'bien', 'warning': 'aviso',
};

/** Texts that are the same in both languages. */
for (const same of ['Rumbo', 'Rumbo ', '10 s', '20 s', '1 min', '5 min', 'ON', 'OFF', 'REF 40', 'USART', 'PWM', '% PWM', 'rpm', 'cm', 'm', '°', 'x', 'y']) PAGE[same] = same;
