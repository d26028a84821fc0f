// Two encoders of one channel each, counted on both edges.

volatile unsigned long right = 0, left = 0;

void setup() {
  pinMode(20, INPUT_PULLUP);
  pinMode(21, INPUT_PULLUP);
  attachInterrupt(digitalPinToInterrupt(20), countRight, CHANGE);
  attachInterrupt(digitalPinToInterrupt(21), countLeft, CHANGE);
}

void countRight() {
  right++;
}

void countLeft() {
  left++;
}

void loop() {
}
