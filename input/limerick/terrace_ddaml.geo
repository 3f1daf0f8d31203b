<?xml version="1.0" standalone="no"?>
<!DOCTYPE DDA SYSTEM "geometry.dtd">
<Berkeley:DDA xmlns:Berkeley="http://www.tsoft.com/~bdoolin/dda">

<!-- The model of terrace.geo: two steps of blocks, a parapet with an opening -->
<Geometry>
  <Edgenodedist distance="0.002"/>
  <Boundlist>
    <Line type="1"> 0 0 12 0 </Line>
    <Line type="1"> 12 0 12 3 </Line>
    <Line type="1"> 12 3 8 3 </Line>
    <Line type="1"> 8 3 8 5 </Line>
    <Line type="1"> 8 5 4 5 </Line>
    <Line type="1"> 4 5 4 3 </Line>
    <Line type="1"> 4 3 0 3 </Line>
    <Line type="1"> 0 3 0 0 </Line>
  </Boundlist>
  <Jointlist>
    <Joint type="2"> -0.1 1 12.1 1 </Joint>
    <Joint type="2"> 4 -0.1 4 3.1 </Joint>
    <Joint type="2"> 8 -0.1 8 3.1 </Joint>
    <Joint type="2"> 3.9 3 8.1 3 </Joint>
    <Joint type="3"> 5 3 5 5 </Joint>
    <Joint type="3"> 7 3 7 5 </Joint>
    <Joint type="3"> 5 4 7 4 </Joint>
    <Joint type="3"> 6 4 6 5 </Joint>
  </Jointlist>
  <Matlinelist>
    <Line type="2"> -0.5 0.5 12.5 0.5 </Line>
  </Matlinelist>
  <Fixedpointlist>
    <Point> 0.5 0.5 </Point>
    <Point> 11.5 0.5 </Point>
    <Line> -1 0.3 13 0.3 </Line>
    <Line> 5 0.6 6 0.6 </Line>
  </Fixedpointlist>
  <Loadpointlist>
    <Point> 5.5 4.5 </Point>
  </Loadpointlist>
  <Measuredpointlist>
    <Point> 6.5 4.5 </Point>
    <Point> 1 2 </Point>
  </Measuredpointlist>
  <Holepointlist>
    <Point> 6 3.5 </Point>
  </Holepointlist>
</Geometry>
</Berkeley:DDA>
