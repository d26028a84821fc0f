// @ts-check
/** Spanish of the guided pages. */

/** @type {Record<string, string>} */
export const GUIDE = {
  'Check the robot': 'Comprobar', 'Check a new robot step by step: motors, encoders, sonars, servo': 'Comprueba paso a paso un robot nuevo: motores, encoders, sonares, servo',
  'left|wheel': 'izquierda', 'right|wheel': 'derecha', 'left|sonar': 'izquierdo', 'right|sonar': 'derecho', 'front|sonar': 'frontal',
  'Wheels in the air': 'Ruedas en el aire', 'Left motor and encoder': 'Motor y encoder izquierdos', 'Right motor and encoder': 'Motor y encoder derechos', 'Sonar: {}': 'Sonar {}', 'Servo': 'Servo',
  'Put the robot on a block so that both wheels hang free. The page arms the robot and turns one wheel at a time; STOP works at any moment.':
    'Pon el robot sobre un taco, con las dos ruedas libres. La página arma el robot y hace girar las ruedas de una en una; PARAR funciona en cualquier momento.',
  'The wheels hang free': 'Las ruedas están libres', 'The {} wheel will turn forward for a moment. Watch it.': 'La rueda {} va a girar hacia delante un momento. Mírala.', 'Turn it': 'Girarla', 'turning…': 'girando…',
  'The encoders counted: left up to {} rpm, right up to {} rpm. What did you see?': 'Los encoders contaron: izquierdo hasta {} rpm, derecho hasta {} rpm. ¿Qué has visto?',
  'the {} wheel turned forward': 'la rueda {} giró hacia delante', 'the {} wheel turned backward': 'la rueda {} giró hacia atrás', 'the other wheel turned': 'giró la otra rueda', 'no wheel turned': 'no giró ninguna',
  'Next': 'Siguiente', 'Again': 'Otra vez', 'Skip': 'Saltar', 'Begin again': 'Empezar de nuevo', 'Hold a hand 10 to 30 cm before the {} sonar.': 'Pon una mano de 10 a 30 cm delante del sonar {}.',
  'The servo is commanded straight ahead, {}°. Where does the front sonar look?': 'Se ordena al servo mirar al frente, {}°. ¿Adónde mira el sonar frontal?',
  'straight ahead': 'al frente', 'to the left': 'a la izquierda', 'to the right': 'a la derecha',
  'There is something to put right:': 'Hay algo que arreglar:', 'All that was checked works. Put the robot on the floor, and calibrate it.': 'Todo lo comprobado funciona. Pon el robot en el suelo y calíbralo.',
  'The {} wheel turns forward, and its encoder counts.': 'La rueda {} gira hacia delante y su encoder cuenta.',
  'The {} wheel turns backward. Swap the two wires of its motor at the driver.': 'La rueda {} gira hacia atrás. Intercambia los dos cables de su motor en el driver.',
  'The {} wheel does not turn. See that the battery is on, that the driver has its supply and its enable wire, and that the motor\'s two wires are tight.':
    'La rueda {} no gira. Mira que la batería esté conectada, que el driver tenga alimentación y su cable de habilitación, y que los dos cables del motor estén firmes.',
  'An encoder counts, although no wheel turns: its signal picks up noise. See its ground wire and keep it away from the motors\' wires.':
    'Un encoder cuenta aunque no gira ninguna rueda: su señal capta ruido. Mira su cable de masa y sepáralo de los cables de los motores.',
  'Motors and encoders are both exchanged. Swap the two motors at the driver, and the two encoders\' signal wires.':
    'Motores y encoders están cambiados. Intercambia los dos motores en el driver y los cables de señal de los dos encoders.',
  'The two motors are exchanged. Swap them at the driver\'s outputs.': 'Los dos motores están cambiados. Intercámbialos en las salidas del driver.',
  'The two encoders are exchanged. Swap their signal wires at the Mega.': 'Los dos encoders están cambiados. Intercambia sus cables de señal en el Mega.',
  'The {} encoder is silent. See its supply, its signal wire, and the gap between its sensor and its disc.':
    'El encoder de la rueda {} calla. Mira su alimentación, su cable de señal y la separación entre el sensor y el disco.',
  'Both encoders count, although one wheel is driven. See that the other wheel hangs free, and the encoders\' ground wires.':
    'Cuentan los dos encoders aunque solo se mueve una rueda. Mira que la otra esté libre, y los cables de masa de los encoders.',
  'The {} sonar sees the hand.': 'El sonar {} ve la mano.',
  'The {} sonar sees the hand instead of the {} one. Swap their trigger and echo wires.': 'El sonar {} ve la mano en lugar del {}. Intercambia sus cables de disparo y eco.',
  'The {} sonar gives no reading. See its 5 V supply, its trigger wire and its echo wire.': 'El sonar {} no da lecturas. Mira su alimentación de 5 V y sus cables de disparo y eco.',
  'The {} sonar does not see the hand. Check that it points where it should, and that nothing is in its beam.': 'El sonar {} no ve la mano. Mira que apunte adonde debe y que no haya nada en su haz.',
  'Turns of the left wheel': 'Vueltas de la rueda izquierda', 'Turns of the right wheel': 'Vueltas de la rueda derecha',
  'Mark a place of the {} tyre: its turns are counted.': 'Haz una marca en el neumático de la rueda {}: se cuentan sus vueltas.', 'Count': 'Contar', 'It has turned': 'Ya ha girado',
  'Turn the {} wheel by hand, {} whole turns one way in about ten seconds.': 'Gira a mano la rueda {}: {} vueltas enteras en un sentido, en unos diez segundos.',
  'Gears and encoder of the {} wheel are as the program counts them, {} edges in a turn.': 'La reductora y el encoder de la rueda {} son como los cuenta el programa: {} flancos por vuelta.',
  'A turn of the {} wheel gives some {} edges, and the program counts with {}: distances and speeds are wrong by that. See the gear ratio of its motor and the poles of its disc, and whether both edges of a pulse are counted.':
    'Una vuelta de la rueda {} da unos {} flancos y el programa cuenta con {}: en esa proporción fallan distancias y velocidades. Mira la reducción del motor, los polos de su disco y si se cuentan los dos flancos de cada pulso.',
  'The servo looks straight ahead.': 'El servo mira al frente.',
  'The servo looks to the left. Take its horn off and put it back a tooth further to the right.': 'El servo mira a la izquierda. Quita su brazo y ponlo un diente más a la derecha.',
  'The servo looks to the right. Take its horn off and put it back a tooth further to the left.': 'El servo mira a la derecha. Quita su brazo y ponlo un diente más a la izquierda.',
  'The robot does not answer. See its power, the cable, and that the speed of the line is the same at both ends.': 'El robot no responde. Mira su alimentación, el cable y que la velocidad de la línea sea la misma en los dos extremos.',
  'Telemetry comes {} times a second, 25 are expected. The line is too slow, or bytes are lost.': 'La telemetría llega {} veces por segundo, se esperan 25. La línea es demasiado lenta o se pierden bytes.',
  '{} frames were damaged. See the ground wire between robot and adapter, and the distance of a Bluetooth module.': 'Hubo {} tramas dañadas. Mira la masa entre el robot y el adaptador, y la distancia del módulo Bluetooth.',
  'The link works: telemetry {} times a second.': 'El enlace funciona: telemetría {} veces por segundo.',
  // Calibration.
  'Calibrate': 'Calibrar', 'Let the robot measure itself: dead zones, feedforward, wheels, base': 'El robot se mide a sí mismo: zonas muertas, prealimentación, ruedas, base',
  '{} s of about {} s': '{} s de unos {} s', 'Begin the calibration': 'Empezar la calibración', 'Put the simulated robot there': 'Poner ahí el robot simulado',
  'The robot finds out by itself: the duty at which each wheel starts, the duty for each speed, the ratio of the wheels\' radii, and the distance between the wheels.':
    'El robot averigua por sí mismo: la PWM con que arranca cada rueda, la PWM de cada velocidad, el cociente de los radios de las ruedas y la distancia entre ellas.',
  'A sonar ahead on the servo and one on each side: sensor layout final. Battery charged.': 'Un sonar al frente sobre el servo y uno a cada lado: montaje final. Batería cargada.',
  'Put it on the floor beside a straight wall, 0.3 to 0.5 m from it and along it, with 2.5 m free ahead.': 'Ponlo en el suelo junto a una pared recta, a 0,3-0,5 m y paralelo a ella, con 2,5 m libres delante.',
  'It drives to and fro along the wall and turns on the spot, for about two and a half minutes. STOP ends it at any moment.':
    'Va y vuelve a lo largo de la pared y gira en el sitio, durante unos dos minutos y medio. PARAR lo detiene en cualquier momento.',
  'The robot calibrates itself. Stay out of its way; STOP ends it.': 'El robot se está calibrando. No te pongas en su camino; PARAR lo detiene.',
  'The calibration came to no end: {}': 'La calibración no llegó a su fin: {}', 'Done. The parameters are set; save them to make that last.': 'Hecho. Los parámetros están puestos; guárdalos para que dure.',
  'found': 'hallado', 'standard error': 'error típico', 'parameter': 'parámetro', 'before': 'antes', 'now': 'ahora', 'Put the old values back': 'Volver a los valores de antes',
  'radius, right over left': 'radio, derecho entre izquierdo', 'base_m (with the mean radius in force)': 'base_m (con el radio medio en vigor)', 'mean radius in force, m': 'radio medio en vigor, m',
  'mean radius by the front sonar, m': 'radio medio según el sonar frontal, m', 'dead zone, left forward, duty': 'zona muerta, izquierda adelante', 'dead zone, right forward, duty': 'zona muerta, derecha adelante',
  'dead zone, left backward, duty': 'zona muerta, izquierda atrás', 'dead zone, right backward, duty': 'zona muerta, derecha atrás',
  'ks_left_forward': 'ks_left_forward', 'ks_left_backward': 'ks_left_backward', 'ks_right_forward': 'ks_right_forward', 'ks_right_backward': 'ks_right_backward', 'kv': 'kv',
  'calibration: the robot drives by itself': 'calibración: el robot se mueve por sí mismo', 'calibration: refused, {}': 'calibración: rechazada, {}', 'calibration: given up, {}': 'calibración: abandonada, {}',
  'calibration: done in {} s, the parameters are set': 'calibración: hecha en {} s, los parámetros están puestos', 'it was stopped': 'se detuvo', 'it was refused: {}': 'se rechazó: {}',
  'calibration: refused, this program has none': 'calibración: rechazada, este programa no la tiene',
  'one is running already': 'ya hay una en marcha', 'no robot answers': 'ningún robot responde', 'this robot has other parameters': 'este robot tiene otros parámetros', 'the robot is armed: switch OFF first': 'el robot está armado: primero OFF',
  'refused, the robot calibrates itself; STOP ends that': 'rechazado, el robot se está calibrando; PARAR lo detiene',
  'the robot does not answer; check the link': 'el robot no responde; comprueba el enlace', '{} was refused: {}': '{} fue rechazado: {}', 'the robot stopped: {}': 'el robot se detuvo: {}',
  'a calibration needs a sonar ahead and one on each side; mount the rig `final` and set the parameter rig': 'una calibración necesita un sonar al frente y uno a cada lado; monta el montaje `final` y fija el parámetro rig',
  'no wall beside the robot (left {}, right {}); put it 0.3 to 0.5 m beside a wall, along it, with 2.5 m free ahead':
    'no hay pared junto al robot (izq. {}, der. {}); ponlo a 0,3-0,5 m de una pared, paralelo a ella, con 2,5 m libres delante', 'nothing': 'nada',
  '{} took too long; is the robot held, or its battery empty?': '{} tardó demasiado; ¿está sujeto el robot, o su batería vacía?',
  'only {} m free along the wall; give it at least 1 m, better 2.5 m': 'solo {} m libres junto a la pared; dale al menos 1 m, mejor 2,5 m',
  'the measurements do not determine {}; is the wall straight, is the robot free to move, and do both wheels turn forward? Check the robot tells': 'las mediciones no determinan {}; ¿es recta la pared, se mueve libre el robot y giran adelante las dos ruedas? Comprobar el robot lo dice',
};
