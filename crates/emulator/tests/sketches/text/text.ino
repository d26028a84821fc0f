// What programs print and read: floats, String, the C library, tables beyond 64 KB, objects, the heap.

#include <avr/pgmspace.h>
#include <setjmp.h>

// Together more than 64 KB, so that what comes behind needs a far pointer.
#define KB16 16384
const char filler_a[KB16] __attribute__((section(".fini7"))) = {1};
const char filler_b[KB16] __attribute__((section(".fini7"))) = {2};
const char filler_c[KB16] __attribute__((section(".fini7"))) = {3};
const char filler_d[KB16] __attribute__((section(".fini7"))) = {4};
const char far_text[] __attribute__((section(".fini7"))) = "far away";

static int put(char letter, FILE *) {
  Serial.write(letter);
  return 0;
}

struct Shape {
  virtual float area() const = 0;
  virtual ~Shape() {}
};

struct Disc : Shape {
  float radius;
  explicit Disc(float r) : radius(r) {}
  float area() const override { return PI * radius * radius; }
};

struct Square : Shape {
  float side;
  explicit Square(float s) : side(s) {}
  float area() const override { return side * side; }
};

struct Starter {
  int value;
  Starter() : value(4711) {}
} starter;

float kp = 2.5, ki = 0.8, kd = 0.05, integral = 0, last_error = 0;

float pid(float reference, float measured, float dt) {
  float error = reference - measured;
  integral = constrain(integral + error * dt, -20.0, 20.0);
  float derivative = (error - last_error) / dt;
  last_error = error;
  return constrain(kp * error + ki * integral + kd * derivative, -255.0, 255.0);
}

int backwards(const void *a, const void *b) {
  return *(const int *)b - *(const int *)a;
}

jmp_buf place;

void deep(int depth) {
  if (depth == 0) longjmp(place, 7);
  deep(depth - 1);
}

void setup() {
  Serial.begin(115200);
  fdevopen(put, 0);

  float measured = 0;
  for (int step = 0; step < 4; step++) {
    float output = pid(30.0, measured, 0.05);
    measured += output * 0.1;
    Serial.print(measured, 4);
    Serial.print(' ');
    Serial.println(output);
  }
  Serial.println(1.0 / 3.0, 6);
  Serial.println(sqrt(-1.0));
  Serial.println(1e20);
  Serial.println(-0.005);
  Serial.println(sin(1.0) * 1000 + atan2(1, -1) + exp(2) + pow(2, 0.5), 3);
  Serial.println(255, HEX);
  Serial.println(-10, BIN);
  Serial.println(4000000000UL);

  String line = "REF " + String(40) + "," + String(1.25, 3);
  line.replace(",", " ");
  line += F(" cm");
  Serial.println(line);
  Serial.println(line.substring(4, 6).toInt() + line.indexOf("cm"));
  line.toLowerCase();
  Serial.println(line.startsWith("ref") ? line.length() : 0);

  char buffer[20];
  dtostrf(3.14159, 8, 2, buffer);
  Serial.println(buffer);
  printf("%5d|%-5s|%04x|%lu\n", -42, "ab", 0xBEEF, 123456789UL);
  char words[] = "GOAL 1.5 -2";
  strtok(words, " ");
  Serial.println(atof(strtok(NULL, " ")) * atoi(strtok(NULL, " ")));

  int numbers[] = {3, 9, -5, 7};
  qsort(numbers, 4, sizeof(int), backwards);
  for (int number : numbers) {
    Serial.print(number);
    Serial.print(';');
  }
  Serial.println(starter.value);

  Shape *shapes[] = {new Disc(2), new Square(3)};
  float total = 0;
  for (Shape *shape : shapes) {
    total += shape->area();
    delete shape;
  }
  Serial.println(total);
  char *piece = (char *)malloc(100);
  char *again = (char *)realloc(piece, 200);
  Serial.println(again == piece);
  free(again);

  uint32_t far = pgm_get_far_address(far_text);
  for (char letter; (letter = pgm_read_byte_far(far)) != 0; far++) Serial.write(letter);
  Serial.println(pgm_read_byte_far(pgm_get_far_address(filler_a)) + pgm_read_byte_far(pgm_get_far_address(filler_b))
                 + pgm_read_byte_far(pgm_get_far_address(filler_c)) + pgm_read_byte_far(pgm_get_far_address(filler_d)));

  int returned = setjmp(place);
  if (returned == 0) deep(10);
  Serial.println(returned);
  Serial.setTimeout(50);
}

void loop() {
  if (Serial.available()) {
    switch (Serial.peek()) {
      case 'i': Serial.read(); Serial.println(Serial.parseInt() * 2); break;
      case 'f': Serial.read(); Serial.println(Serial.parseFloat() * 2, 3); break;
      default: Serial.println("<" + Serial.readStringUntil('\n') + ">");
    }
  }
}
