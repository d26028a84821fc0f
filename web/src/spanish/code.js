// @ts-check
/** The code pane and the debugger, in Spanish. */

/** @type {Record<string, string>} */
export const CODE = {
  Code: 'Código', 'The program\'s code: change it, run it, debug it': 'El código del programa: cámbialo, ejecútalo, depúralo',
  Sketch: 'Sketch', Files: 'Archivos', Run: 'Ejecutar', Debug: 'Depurar', 'Save the file': 'Guardar el archivo',
  'Compile it and run it on the simulated robot (Ctrl+Enter)': 'Lo compila y lo ejecuta en el robot simulado (Ctrl+Intro)',
  'Compile it for the debugger: it stands at the first breakpoint, else at its first line': 'Lo compila para el depurador: se detiene en el primer punto de interrupción o, si no hay, en su primera línea',
  'Save the file that is shown to this computer': 'Guarda en este ordenador el archivo que se ve',
  'Open a sketch…': 'Abrir un sketch…', 'no .ino is among these files': 'entre estos archivos no hay ningún .ino', '{} is here: Run compiles it': '{} está aquí: Ejecutar lo compila',
  'Open the .ino of a sketch and the files beside it; an .ino that is dropped on the page runs at once': 'Abre el .ino de un sketch y los archivos que lo acompañan; un .ino que se suelta en la página se ejecuta al momento',
  'Discard changes': 'Descartar los cambios', 'Back to the files that the lab has': 'Vuelve a los archivos que tiene el laboratorio',
  'the sketch that drives': 'el sketch que conduce', 'example: {}': 'ejemplo: {}',
  'changed; kept in this browser': 'con cambios, que guarda este navegador',
  'this browser stores nothing: save the file': 'este navegador no guarda nada: guarda el archivo',
  'Source; Escape, then Tab leaves it': 'Código fuente; se sale con Escape y luego Tab',
  'code: go on or pause, breakpoint, step over; Ctrl+Enter runs it, Escape and then Tab leaves it': 'código: seguir o parar, punto de interrupción, paso; Ctrl+Intro lo ejecuta, Escape y luego Tab sale de él',
  Find: 'Buscar', Replace: 'Reemplazar', 'next|search': 'siguiente', 'previous|search': 'anterior', 'all|search': 'todos', 'match case': 'mayúsculas y minúsculas',
  'whole words': 'palabras enteras', 'regular expression': 'expresión regular', 'replace|search': 'reemplazar', 'replace all': 'reemplazar todos',
  'Go to line': 'Ir a la línea', 'go|line': 'ir',
  Debugger: 'Depurador', Continue: 'Continuar', 'Go on to the next breakpoint, or stand where it is (F8)': 'Sigue hasta el próximo punto de interrupción, o se detiene donde está (F8)',
  'Step over': 'Paso', 'To the next line, over calls (F10)': 'A la línea siguiente, sin entrar en las llamadas (F10)',
  'Step into': 'Entrar', 'Into the function that is called': 'Entra en la función que se llama',
  'Step out': 'Salir', 'Out to the caller': 'Sale a quien llamó',
  'Step back': 'Paso atrás', 'Back to the line before, with the values that it had': 'Vuelve a la línea anterior, con los valores que tenía',
  End: 'Terminar', 'Start again without the debugger': 'Empieza de nuevo sin el depurador',
  'Calls, innermost first': 'Llamadas, la más interna primero', Variables: 'Variables',
  'stands: time stands still': 'detenido: el tiempo no corre', 'runs under the debugger': 'corre con el depurador',
  'stands at {} s: the robot and its time with it': 'detenido en {} s, y con él el robot y su tiempo',
  'stands in the past, at {} s: the robot and its time with it': 'detenido en el pasado, en {} s, y con él el robot y su tiempo',
  'none|variables': 'ninguna', Locals: 'Locales', Globals: 'Globales', 'Core and libraries': 'Core y bibliotecas', Pins: 'Pines', 'I/O registers': 'Registros de E/S', CPU: 'CPU',
  // Of the debugger.
  'the program runs; pause it first': 'el programa corre; páralo antes', 'the program stands nowhere': 'el programa no está detenido en ningún sitio',
  'the program has gone on since': 'el programa ha seguido desde entonces',
  'nothing has called this function: there is no step out of it': 'nada ha llamado a esta función: no se puede salir de ella',
  'debugger: {}': 'depurador: {}', 'a debugger has the program; end that first': 'un depurador tiene el programa; termina antes con él',
  'the program is not being debugged, or a page may not ask that; begin with Debug': 'el programa no se está depurando, o una página no puede pedir eso; empieza con Depurar',
};
