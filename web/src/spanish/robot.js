// @ts-check
/** Spanish of what the robot and the station say: modes, states, faults, refusals, commands and their fate. */

/** @type {Record<string, string>} */
export const ROBOT = {
  // Modes.
  'manual': 'manual', 'front distance': 'distancia', 'front align': 'alinear', 'wall hold': 'mantener pared', 'wall follow': 'seguir pared',
  'wheel speed': 'velocidad', 'straight line': 'línea recta', 'waypoints': 'ruta', 'mission': 'misión',
  'basic movements, open loop or by speed': 'movimientos básicos, en lazo abierto o por velocidad',
  'stop at a distance from the wall ahead': 'parar a una distancia de la pared de enfrente',
  'stop square to the wall ahead, at a distance from it': 'parar perpendicular a la pared de enfrente, a una distancia de ella',
  'follow a wall at the distance at which the robot starts': 'seguir una pared a la distancia a la que empieza el robot',
  'follow a wall at a commanded distance': 'seguir una pared a la distancia de referencia',
  'each wheel at a commanded speed': 'cada rueda a la velocidad de referencia',
  'straight on at a commanded speed': 'en línea recta a la velocidad de referencia',
  'visit the waypoints of a route in turn, such as a square of 1 m': 'visitar por orden los puntos de una ruta, como un cuadrado de 1 m',
  'reach a goal around obstacles, or follow a lane of boxes': 'llegar a un destino rodeando obstáculos, o seguir un carril de cajas',
  // Groups of parameters.
  'arcs': 'arcos', 'approach to the wall': 'acercamiento a la pared', 'straightening': 'corrección del rumbo', 'angle to the wall': 'ángulo con la pared',
  'along the wall': 'a lo largo de la pared', 'distance to the wall': 'distancia a la pared', 'ramp': 'rampa', 'route': 'ruta', 'lane': 'carril',
  'speed loops': 'lazos de velocidad', 'feedforward': 'prealimentación', 'ramps of the wheels': 'rampas de las ruedas', 'turns on the spot': 'giros en el sitio',
  'straight lines': 'líneas rectas',
  // Values of parameters.
  'yes': 'sí', 'no': 'no', 'straight': 'línea recta y giros',
  // Recordings.
  'no recording has this name; load the list again': 'ninguna grabación tiene este nombre; carga la lista otra vez', 'it is being recorded: it can be deleted when it has ended': 'se está grabando: se puede borrar cuando termine',
  'it is no log of Rumbo: delete it by hand': 'no es una grabación de Rumbo: bórrala a mano', '{}; check the permissions of the folder': '{}; revisa los permisos de la carpeta',
  'recordings are shown only where no other computer reaches the page': 'las grabaciones solo se muestran donde ningún otro ordenador llega a la página', 'nothing is recorded here': 'aquí no se graba nada',
  'another page has control; take it first': 'otra página tiene el control; tómalo primero', 'a fault of the program; please report it': 'un fallo del programa; por favor, comunícalo',
  // Rigs.
  'front single': 'un frontal', 'front pair': 'dos frontales', 'side pair left': 'dos a la izquierda', 'side pair right': 'dos a la derecha', 'final': 'final',
  // States.
  'off': 'apagado', 'fault': 'fallo', 'armed': 'armado', 'state {}': 'estado {}', 'stop': 'parar', 'open loop': 'lazo abierto', 'by speed': 'por velocidad',
  'approach': 'acercarse', 'settle': 'asentarse', 'hold': 'mantener', 'look': 'mirar', 'turn': 'girar', 'measure': 'medir', 'follow': 'seguir', 'slow': 'despacio',
  'at rest': 'en reposo', 'turning': 'girando', 'drive': 'avanzar', 'wait': 'esperar', 'pursue': 'perseguir', 'final turn': 'giro final', 'done': 'acabado',
  'wait for goal': 'esperar destino', 'initial turn': 'giro inicial', 'initialise': 'iniciar', 'go to goal': 'ir al destino', 'sweep right': 'barrer a la derecha',
  'sweep left': 'barrer a la izquierda', 'decide': 'decidir', 'avoidance turn': 'giro de evasión', 'advance seeking the obstacle': 'avanzar buscando el obstáculo',
  'advance along it': 'avanzar a su lado', 'advance a safe distance': 'avanzar distancia de seguridad', 'unreachable': 'inalcanzable', 'straight on': 'recto', 'prove the front sonar': 'comprobar el sonar delantero', 'reached': 'alcanzado',
  // Why a state leads to another.
  '12.5 cm on': '12,5 cm más', 'a goal arrives': 'llega un destino', 'a movement by duty': 'un movimiento por PWM',
  'a movement by speed': 'un movimiento por velocidad', 'a setpoint that is not zero': 'una referencia que no es cero',
  'a waypoint is appended': 'se añade un punto de ruta', 'an obstacle ahead': 'un obstáculo delante', 'askew for 0.3 s': 'torcido durante 0,3 s',
  'at the last waypoint already': 'ya en el último punto de ruta', 'at the waypoint already, which has a heading': 'ya en el punto de ruta, que tiene rumbo',
  'beyond 6 cm': 'a más de 6 cm', 'beyond twice the tolerance for 0.15 s': 'más del doble de la tolerancia durante 0,15 s',
  'both setpoints are zero': 'las dos referencias son cero',
  'both wheels stand and the setpoint is not zero': 'las ruedas paradas y la referencia no es cero',
  'both wheels stand and there is a waypoint': 'las ruedas paradas y hay un punto de ruta', 'clear again': 'libre otra vez',
  'clear again, far from the distance': 'libre otra vez, lejos de la distancia', 'far from the distance': 'lejos de la distancia',
  'it faces past the end': 'encarado más allá del extremo', 'it faces the goal': 'encarado al destino',
  'it faces the last waypoint\'s heading': 'con el rumbo del último punto de ruta', 'it faces the lookahead': 'encarado al punto de anticipación',
  'it faces the waypoint': 'encarado al punto de ruta', 'it faces the waypoint already': 'ya encarado al punto de ruta',
  'it faces the waypoint\'s heading': 'con el rumbo del punto de ruta',
  'it stands and the lookahead is far to a side': 'parado y el punto de anticipación muy a un lado', 'it stands at the goal': 'parado en el destino',
  'it stands at the last waypoint': 'parado en el último punto de ruta', 'it stands at the waypoint': 'parado en el punto de ruta',
  'it stands at the waypoint, which has a heading': 'parado en el punto de ruta, que tiene rumbo',
  'lane: a quarter turn, or half a turn': 'carril: un cuarto de vuelta, o media', 'lane: begin': 'carril: empezar',
  'lane: it faces the heading': 'carril: con el rumbo', 'lane: stands before a face': 'carril: parado ante una cara',
  'the front sonar is in doubt': 'duda del sonar delantero', 'it hears': 'oye', 'it hears, beside an obstacle': 'oye, junto a un obstáculo',
  'it hears, before an obstacle': 'oye, ante un obstáculo', 'it hears, along an obstacle': 'oye, a lo largo de un obstáculo', 'it hears, around a corner': 'oye, en torno a una esquina',
  'looked to the left': 'ha mirado a la izquierda', 'looked to the right': 'ha mirado a la derecha', 'near the distance': 'cerca de la distancia',
  'pure pursuit': 'persecución pura', 'slow enough': 'bastante despacio', 'something ahead, or a sonar in doubt': 'algo delante, o un sonar dudoso',
  'square': 'perpendicular', 'the bearing is known': 'se conoce el ángulo', 'the distance is known': 'se conoce la distancia',
  'the distance is known, far from it': 'se conoce la distancia, lejos de ella', 'the goal is not ahead': 'el destino no está delante',
  'the obstacle that it has just left': 'el obstáculo que acaba de dejar', 'the setpoint has the old sign again': 'la referencia vuelve a su signo',
  'the setpoint is zero or has the other sign': 'la referencia es cero o cambia de signo', 'the shorter way round': 'el rodeo más corto',
  'the sonar beside loses the obstacle': 'el sonar de ese lado pierde el obstáculo',
  'the sonar beside sees the obstacle': 'el sonar de ese lado ve el obstáculo', 'the way past is far from ahead': 'el paso no queda delante',
  'the way to the goal is clear': 'el camino al destino está libre', 'there is no way': 'no hay camino', 'within 5 cm': 'a menos de 5 cm',
  'within the tolerance': 'dentro de la tolerancia', 'within the tolerance, askew': 'dentro de la tolerancia, torcido',
  // Faults, each with its cause.
  'link lost: no heartbeat arrived in time; check the connection, then clear and arm again':
    'enlace perdido: no llegó ningún latido a tiempo; comprueba la conexión, borra el fallo y arma otra vez',
  'sonar faulty: its echo line is silent, or its readings jump; check its wiring, and see that it faces no corner, gap or slanted box':
    'sonar averiado: su línea de eco calla o sus lecturas saltan; comprueba su cableado y que no mire a una esquina, un hueco o una caja oblicua',
  'sonar stale: no good reading for too long; is something absorbing the echo?':
    'sonar sin lecturas: ninguna buena desde hace demasiado; ¿hay algo que absorbe el eco?',
  'wall lost: nothing within the sonar\'s reach; face the robot to a wall': 'pared perdida: nada al alcance del sonar; pon el robot frente a una pared',
  'left encoder silent: the wheel is driven but does not turn, or its sensor is cut': 'encoder izquierdo en silencio: la rueda recibe PWM y no gira, o su sensor está cortado',
  'right encoder silent: the wheel is driven but does not turn, or its sensor is cut': 'encoder derecho en silencio: la rueda recibe PWM y no gira, o su sensor está cortado',
  'left encoder implausible: it loses edges or picks up noise; see its wires, its ground, and the gap between sensor and magnet':
    'encoder izquierdo no creíble: pierde flancos o capta ruido; comprueba sus cables, su masa y la distancia entre sensor e imán',
  'right encoder implausible: it loses edges or picks up noise; see its wires, its ground, and the gap between sensor and magnet':
    'encoder derecho no creíble: pierde flancos o capta ruido; comprueba sus cables, su masa y la distancia entre sensor e imán',
  'battery low: charge it': 'batería baja: cárgala',
  'a value was not a finite number; reset the parameters': 'un valor no era un número finito; vuelve a los parámetros de fábrica',
  'a control tick took too long': 'un paso de control tardó demasiado',
  'blocked: something stands in the way; clear the way or turn the robot, then clear the fault and arm again':
    'bloqueado: hay algo en el camino; despéjalo o gira el robot, borra el fallo y arma otra vez',
  // Refusals, each with its remedy.
  'the value is not a finite number; send a number': 'el valor no es un número finito; envía un número',
  'the value is outside the allowed range; see the limits with `rumbo list`': 'el valor está fuera del rango permitido; mira los límites con `rumbo list`',
  'no such parameter; see `rumbo list`': 'no hay tal parámetro; mira `rumbo list`',
  'the selected mode takes no such command; select the mode that does': 'el modo elegido no admite esa orden; elige el modo que sí',
  'not while armed; disarm first': 'no mientras está armado; desarma primero',
  'a fault is latched; remove its cause and clear it first': 'hay un fallo retenido; quita su causa y bórralo primero',
  'the sonar this mode needs gives no good reading; check its wiring': 'el sonar que necesita este modo no da buenas lecturas; comprueba su cableado',
  'no wall within reach of the sonar this mode needs; put the robot within 2.5 m of one':
    'no hay ninguna pared al alcance del sonar que necesita este modo; pon el robot a menos de 2,5 m de una',
  'it is too old: given more than 2 s ago, or before the robot started again; give the order again':
    'es demasiado antigua: se dio hace más de 2 s, o antes de que el robot volviera a arrancar; da la orden otra vez',
  'no heartbeat arrives at the robot; connect, then arm again': 'al robot no le llega ningún latido; conecta y arma otra vez',
  'the robot did not understand the command; use the same version at both ends': 'el robot no entendió la orden; usa la misma versión en los dos extremos',
  'the robot\'s sonars do not sit where this mode needs them; mount them so and set the parameter `rig`':
    'los sonares del robot no están donde este modo los necesita; móntalos así y fija el parámetro `rig`',
  'allowed is one of {}': 'se permite uno de {}', 'allowed is {} to {}': 'se permite de {} a {}', 'allowed is {} to {} m for each coordinate': 'se permite de {} a {} m en cada coordenada',
  'allowed is -{} to {} m for each coordinate, and {} waypoints': 'se permite de -{} a {} m en cada coordenada, y {} puntos de ruta', 'out of range': 'fuera de rango',
  'not confirmed': 'sin confirmar', 'too many commands wait for the robot': 'demasiadas órdenes esperan al robot',
  'no robot answers; check that it is on and in reach, then give the order again': 'no responde ningún robot; comprueba que está encendido y al alcance, y da la orden otra vez',
  'the port is gone; give the order again when it is back': 'el puerto ya no está; da la orden otra vez cuando vuelva',
  'the robot has another parameter table': 'el robot tiene otra tabla de parámetros',
 
  'the battery is low; charge it': 'la batería está baja; cárgala',
  // Why the robot's program started.
  'power on': 'encendido', 'reset button or serial adapter': 'botón de reinicio o adaptador serie',
  'the supply dipped; charge the battery, check the cables': 'la alimentación bajó; carga la batería, comprueba los cables',
  'the watchdog: the program hung; please report it': 'el watchdog: el programa se colgó; avísanos, por favor',
  // Events.
  'disarmed': 'desarmado', 'fault: {}': 'fallo: {}', 'fault cleared': 'fallo borrado', 'fault cleared: {}': 'fallo borrado: {}', 'mode changed': 'modo cambiado', 'mode changed: {}': 'modo cambiado: {}',
  'setpoint reached': 'referencia alcanzada', 'goal unreachable': 'destino inalcanzable', 'goal unreachable: {}': 'destino inalcanzable: {}',
  'every way round was tried; give another goal, or clear the way': 'se probó a rodear por todos lados; da otro destino o despeja el camino',
  'connected; the robot\'s program started after: {}': 'conectado; el programa del robot arrancó por: {}',
  'the robot\'s program started again: {}; it needs a new ON': 'el programa del robot arrancó de nuevo: {}; hay que volver a pulsar ON',
  // Alarms.
  'ALARM: {}': 'ALARMA: {}',
  'ALARM: the robot does not confirm STOP; switch off its battery': 'ALARMA: el robot no confirma PARAR; desconecta su batería',
  'the robot\'s clock ran back without a restart: its times are wrong; switch it off, and flash it again':
    'el reloj del robot ha retrocedido sin que el robot arrancara de nuevo: sus tiempos no son fiables; apágalo y grábalo otra vez',
  'the robot\'s clock jumped ahead: its times are wrong; switch it off, and flash it again':
    'el reloj del robot ha dado un salto hacia delante: sus tiempos no son fiables; apágalo y grábalo otra vez',
  'the robot\'s clock runs at another speed than the station\'s: check that its program is built for its crystal':
    'el reloj del robot no va a la misma velocidad que el de la estación: comprueba que su programa está compilado para su cristal',
  'the robot sends far more than it should: switch it off, and flash it again': 'el robot envía muchas más tramas de las debidas: apágalo y grábalo otra vez',
  'the robot repeats what it said before: what is shown may be old; switch it off, and check what is on the link':
    'el robot repite lo que ya dijo: lo que se muestra puede ser antiguo; apágalo y comprueba qué hay en el enlace',
  'refused: this page may watch, and stop the robot': 'rechazado: esta página puede mirar, y parar el robot',
  'refused: another page has control; take it first': 'rechazado: otra página tiene el control; tómalo antes',
  'connected; the robot speaks the original program\'s text: nothing is acknowledged, and it goes on by itself when the link is lost':
    'conectado; el robot habla el texto del programa original: nada se confirma, y sigue por su cuenta si se pierde el enlace',
  'nothing received from the robot for some seconds, though it is on': 'no se recibe nada del robot desde hace unos segundos, aunque está en marcha',
  'bytes arrive that are neither frames nor rows of text: is {} baud the robot\'s speed? --baud sets it':
    'llegan bytes que no son ni tramas ni líneas de texto: ¿es {} baudios la velocidad del robot? Se fija con --baud',
  'the link is full: the robot left out {} telemetry frames': 'el enlace está lleno: el robot omitió {} tramas de telemetría',
  'the link is disturbed: {} damaged frames within 10 s; come nearer, or check the cable':
    'hay perturbaciones en el enlace: {} tramas dañadas en 10 s; acércate o revisa el cable',
  '{}: sent, text is not acknowledged': '{}: enviado, el texto no se confirma',
  'link lost: nothing received from the robot for a second; trying again': 'enlace perdido: no se recibe nada del robot desde hace un segundo; reintentando',
  'the robot speaks protocol {}, this station {}: flash the robot or update the station': 'el robot habla el protocolo {}, esta estación el {}: graba el robot o actualiza la estación',
  'the robot has another parameter table: parameters are neither shown nor written': 'el robot tiene otra tabla de parámetros: ni se muestran ni se escriben',
  'the ghost has stopped: {}': 'el fantasma se ha detenido: {}',
  'the ghost starts again where the robot is': 'el fantasma empieza de nuevo donde está el robot', 'the ghost: refused, {}': 'el fantasma: rechazado, {}',
  'there is none; start with --ghost': 'no hay ninguno; arranca con --ghost',
  'the robot is gone: {}': 'el robot ya no está: {}', '{}: not sent, {}': '{}: no enviado, {}', 'this robot takes no lines of text from here': 'a este robot no se le escriben líneas desde aquí',
  'the port is gone': 'el puerto ya no está', 'this robot speaks the original\'s text, which has no words for it': 'este robot habla el texto del original, que no tiene palabras para eso',
  'compiling a sketch needs rumbo on a computer; drop the .elf or .hex that a compiler made': 'compilar un sketch necesita rumbo en un ordenador; suelta el .elf o .hex que hizo un compilador',
  'not sent: the lab of this page is not there': 'no enviado: el laboratorio de esta página no está',
  'this browser has no WebAssembly or no workers; open the page in another one': 'este navegador no tiene WebAssembly o no tiene workers; abre la página en otro',
  'the link is of version {}, this is {}: the run may differ': 'el enlace es de la versión {}, esta es la {}: puede salir distinto',
  'the link is not for this version: {}': 'el enlace no es para esta versión: {}',
  'the link has {} changes of commands, and {} are the most: only the first ones are repeated': 'el enlace tiene {} cambios de órdenes, y {} es el máximo: solo se repiten los primeros',
  'the link repeats a run driven by hand until {} s (changes of commands: {}); an order given here ends that':
    'el enlace repite una ejecución llevada a mano hasta {} s (cambios de órdenes: {}); una orden dada aquí termina eso',
  'the link\'s commands are left out: {}': 'las órdenes del enlace se omiten: {}',
  'the link drives no further: an order was given here': 'el enlace ya no da órdenes: se ha dado una aquí',
  'the link drives no further than {} s': 'el enlace no da órdenes más allá de {} s',
  'until {} s this is the run of the link, bit for bit': 'hasta {} s esta es la ejecución del enlace, bit a bit',
  'this is not the run of the link: that one is of another version, or the link was changed': 'esta no es la ejecución del enlace: aquella es de otra versión, o se cambió el enlace',
  'a link has at most {} changes of commands, this run has {}': 'un enlace tiene como mucho {} cambios de órdenes, y esta ejecución tiene {}',
  'a link has at most 2 KB, this one would be longer': 'un enlace tiene como mucho 2 KB, y este sería más largo',
  'a program of your own is not in a link': 'un programa propio no va en un enlace', 'a calibration is not in a link': 'una calibración no va en un enlace',
  'the robot began with parameters that are saved on it': 'el robot empezó con parámetros guardados en él',
  'the recording is full: save it, and reset for another one': 'la grabación está llena: guárdala, y reinicia para empezar otra',
  'its program could not be loaded': 'no se pudo cargar su programa',
  'there is no emulated chip; start the lab with --firmware': 'no hay chip emulado; arranca el laboratorio con --firmware',
  'no such scenario or world here; choose one of the list': 'aquí no hay ese escenario o ese mundo; elige uno de la lista',
  'the log has no signals': 'la grabación no tiene señales', 'the robot\'s pose at that time is not in the log': 'la grabación no tiene la pose del robot en ese instante',
  '{}: the thread of the port has ended; please report it': '{}: el hilo del puerto ha terminado; por favor, avísanos',
  'it ended by a fault of its own; please report it': 'terminó por un fallo propio; por favor, avísanos',
  'speed: refused, a real robot runs in real time': 'velocidad: rechazado, un robot real va en tiempo real', 'refused, this is no replay of a log': 'rechazado, esto no es una grabación',
  'reset: refused, this is a real robot': 'reinicio: rechazado, es un robot real', 'this is a real robot': 'es un robot real', 'reset: refused, {}': 'reinicio: rechazado, {}',
  'reset: {}, seed {}': 'reinicio: {}, semilla {}', 'reset: {} in world {}, seed {}': 'reinicio: {} en el mundo {}, semilla {}',
  'reset: {} with rig {}, seed {}': 'reinicio: {} con el montaje {}, semilla {}', 'reset: {} in world {} with rig {}, seed {}': 'reinicio: {} en el mundo {} con el montaje {}, semilla {}',
  'collision: the robot touches something': 'colisión: el robot toca algo', 'the changed program runs, from the start': 'el programa modificado está en marcha, desde el principio',
  'the changed program does not compile: the robot is switched off until it does': 'el programa modificado no compila: el robot está apagado hasta que compile',
  'compiler: {}': 'compilador: {}', 'program: refused, {}': 'programa: rechazado, {}', 'only an .ino, .elf or .hex file is a program for the Mega': 'solo un archivo .ino, .elf o .hex es un programa para el Mega',
  'refused: a program is taken only where no other computer reaches the page': 'rechazado: solo se acepta un programa donde ningún otro ordenador alcanza la página',
  'the program does not compile; correct it and save': 'el programa no compila; corrígelo y guárdalo', 'this robot takes no program from a page': 'este robot no acepta programas desde una página',
  'recording to {}': 'grabando en {}', 'not recording: {}': 'no se graba: {}', 'recording ended: the log cannot be written ({}); is the disk full?': 'fin de la grabación: no se puede escribir ({}); ¿disco lleno?',
  'recording: the disk is slow, {} entries are missing in the log': 'grabación: el disco es lento, faltan {} entradas',
  'recording: more came in this second than a robot says; {} bytes of the link and {} samples and events are left out':
    'grabación: en este segundo llegó más de lo que un robot dice; se omiten {} bytes del enlace y {} muestras y eventos',
  'about the log: {}': 'sobre la grabación: {}',
  '{}: cannot be read ({})': '{}: no se puede leer ({})',
  '{}: is no MCAP log; give a log of rumbo, or convert a CSV with `rumbo import`': '{}: no es una grabación MCAP; usa una de rumbo, o convierte un CSV con `rumbo import`',
  '{}: ends before its first record: its writer was stopped at once, or it was cut off when it was copied; nothing of it can be read':
    '{}: acaba antes de su primer registro: quien la escribía se detuvo enseguida, o se cortó al copiarla; no se puede leer nada de ella',
  '{}: ends before anything of rumbo in it; was it cut off when it was copied, or is it another program\'s log?':
    '{}: acaba antes de que haya en ella algo de rumbo; ¿se cortó al copiarla, o es la grabación de otro programa?',
  '{}: holds neither a manifest nor signals of rumbo; is it another program\'s log?': '{}: no contiene ni un manifiesto ni señales de rumbo; ¿es la grabación de otro programa?',
  '{}: nothing of what happened can be had from it: {}': '{}: no se puede sacar nada de lo que pasó: {}',
  '{}: not opened, a recording has at most {} MB here; `rumbo replay` shows it on a computer': '{}: no se abre, aquí una grabación tiene como mucho {} MB; `rumbo replay` la muestra en un ordenador',
  '{}: not opened, it does not fit into the memory of the page; `rumbo replay` shows it on a computer': '{}: no se abre, no cabe en la memoria de la página; `rumbo replay` la muestra en un ordenador',
  'the log is damaged: {}': 'la grabación está dañada: {}',
  'the log ends early: {}': 'la grabación acaba antes de tiempo: {}', 'this is a replay: nothing is sent to a robot': 'esto es una grabación: no se envía nada a ningún robot',
  'another page of this browser drives a robot: go back to its lab first': 'otra página de este navegador está conduciendo un robot: vuelve antes en ella al laboratorio',
  'port {} cannot be opened ({}): is it in use by another program, is the robot switched on?': 'no se puede abrir el puerto {} ({}): ¿lo está usando otro programa, está encendido el robot?',
  'not while a real robot is driven: go back to the lab first': 'no mientras se conduce un robot real: vuelve antes al laboratorio',
  'the recording is full: save it, and connect again for another one': 'la grabación está llena: guárdala y vuelve a conectar para empezar otra',
  'there are two of the kind: choose one again': 'hay dos iguales: elige uno otra vez', 'the browser does not offer it: plug it in, or choose it again': 'el navegador no lo ofrece: enchúfalo o elígelo otra vez',
  'port {} is gone ({}); waiting for it': 'el puerto {} ya no está ({}); se espera a que vuelva', 'port {} is back': 'el puerto {} ha vuelto',
  'saved parameters': 'parámetros guardados', 'saved parameters: {}': 'parámetros guardados: {}', 'parameters saved on the robot': 'parámetros guardados en el robot',
  'in force since the start, from the first copy': 'en vigor desde el arranque, de la primera copia',
  'in force since the start, from the second copy': 'en vigor desde el arranque, de la segunda copia',
  'in force since the start, from the first copy; the second is damaged or of another version: save again':
    'en vigor desde el arranque, de la primera copia; la segunda está dañada o es de otra versión: guarda otra vez',
  'in force since the start, from the second copy; the first is damaged or of another version: save again':
    'en vigor desde el arranque, de la segunda copia; la primera está dañada o es de otra versión: guarda otra vez',
  'not used: both copies are damaged or of another version; the defaults are in force: set the parameters and save':
    'sin usar: las dos copias están dañadas o son de otra versión; rigen los de fábrica: fija los parámetros y guarda',
  'save the parameters on the robot': 'guardar los parámetros en el robot',
  // Commands, and how they ended.
  'sent: {}': 'enviado: {}',
  '{}: acknowledged': '{}: confirmado', '{}: refused, {}': '{}: rechazado, {}', '{}: given up, STOP or OFF came after it': '{}: abandonado, después vino PARAR u OFF',
  '{}: given up, the link was lost; it is not sent later': '{}: abandonado, se perdió el enlace; no se envía después',
  '{}: given up, the robot did not answer in time': '{}: abandonado, el robot no respondió a tiempo', '{}: given up, the robot started again': '{}: abandonado, el robot arrancó de nuevo',
  'clear the fault': 'borrar el fallo', 'mode {} {}': 'modo {} {}', 'setpoint {} cm': 'referencia {} cm', 'setpoint {} rpm': 'referencia {} rpm',
  'setpoints left {} rpm, right {} rpm': 'referencias izq. {} rpm, der. {} rpm', 'movement {} with {} % PWM': 'movimiento {} con {} % PWM', 'movement {} at {} rpm': 'movimiento {} a {} rpm',
  'read {}': 'leer {}', 'all parameters to their defaults': 'todos los parámetros a los de fábrica', 'the current position is the origin': 'la posición actual es el origen',
  'goal ({}, {}) m': 'destino ({}; {}) m', 'follow the lane': 'seguir el carril', 'a new route, again and again': 'una ruta nueva, una y otra vez', 'a new route, once': 'una ruta nueva, una vez',
  'waypoint ({}, {}) m': 'punto de ruta ({}; {}) m', '{} = {}': '{} = {}',
  // Logs of version 0.1 say it so.
  '{}: done': '{}: hecho', 'reference {} cm': 'referencia {} cm', 'reference {} rpm': 'referencia {} rpm', 'reference reached': 'referencia alcanzada',
  'references left {} rpm, right {} rpm': 'referencias izq. {} rpm, der. {} rpm', 'the present place is the origin': 'el lugar actual es el origen',
  'nothing heard from the robot for some seconds, though it is on': 'el robot no dice nada desde hace unos segundos, aunque está en marcha',
  'link lost: nothing heard from the robot for a second; trying again': 'enlace perdido: el robot no dice nada desde hace un segundo; reintentando',
  // Why the station closed the connection.
  'not understood: {}': 'no entendido: {}', 'too many orders at once': 'demasiadas órdenes a la vez',
  'too many pages are open: close some of them': 'hay demasiadas páginas abiertas: cierra alguna',
};

/** Names as commands have them, which are read as those of the buttons. */
export const UNDERSCORED = ['front_distance', 'front_align', 'wall_hold', 'wall_follow', 'wheel_speed', 'straight_line', 'front_single', 'front_pair', 'side_pair_left', 'side_pair_right', 'pure_pursuit'];
for (const name of UNDERSCORED) ROBOT[name] = ROBOT[name.replaceAll('_', ' ')] ?? name;
